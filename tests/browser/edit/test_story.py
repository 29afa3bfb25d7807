"""The whole story of an editor: parts found, corrected, merged and named are kept, and other programs read them."""

import json

import numpy as np
import pytest
import trimesh

from helpers.bodies.creatures import creature
from helpers.browser.edits import EditedJob, across, choose, stroke, wait_for_preview, wait_for_revision
from helpers.browser.visit import Visit
from helpers.files.written import mesh_bytes
from helpers.installation import Installation


@pytest.fixture
def edited(installation: Installation) -> EditedJob:
    return EditedJob(installation.url, "creature.ply", mesh_bytes(creature(), "ply"))


def test_parts_that_were_edited_are_found_in_the_files_by_other_programs(visit: Visit, edited: EditedJob) -> None:
    visit.open_job(edited.id, "&k=2")
    choose(visit, "part")
    limb = max(visit.grid(12), key=lambda place: (visit.parts_at([place])[0] >= 0, place[1]))  # the lowest point
    visit.page.mouse.click(limb[0], limb[1] - 6)
    wait_for_preview(visit)
    visit.page.keyboard.press("Enter")
    wait_for_revision(visit, 1)

    found = visit.selected()[0]
    choose(visit, "border")
    before = edited.labels()
    stroke(visit, *across(visit, found, 0.3))
    wait_for_revision(visit, 2)
    assert (edited.labels() != before).any()

    choose(visit, "cut")
    stroke(visit, *across(visit, found, 0.6))
    wait_for_revision(visit, 3)
    choose(visit, "select")
    count = len(visit.parts())
    visit.row(visit.parts()[0]).click()
    visit.row(visit.parts()[-1]).click(modifiers=["Control"])
    visit.page.click("#merge")  # two parts that no cut of the tree separates from all others
    wait_for_revision(visit, 4)
    assert len(visit.parts()) == count - 1

    names = ["body", "knee", "left foot"][: count - 1]
    for place, name in enumerate(names):
        visit.row(visit.parts()[place]).click()
        visit.page.fill("#part-name", name)
        visit.page.keyboard.press("Enter")
        wait_for_revision(visit, 5 + place)

    visit.page.reload()
    visit.wait_for_parts()
    wait_for_revision(visit, 4 + len(names))
    assert visit.rows()[: len(names)] == names
    visit.page.click("#open-download")
    with visit.page.expect_download() as model:
        visit.page.click("[data-format=glb]")
    with visit.page.expect_download() as labels:
        visit.page.click("[data-format=json]")
    document = json.loads(labels.value.path().read_text())
    sizes = np.bincount(document["labels"])
    assert document["names"][: len(names)] == names
    assert document["labels"] == edited.labels().tolist()
    scene = trimesh.load_scene(model.value.path(), file_type="glb")
    assert {name: len(scene.geometry[name].faces) for name in names} == dict(zip(names, sizes, strict=False))
    assert sum(len(part.faces) for part in scene.geometry.values()) == len(document["labels"])
