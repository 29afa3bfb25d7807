"""Everything that is taken away is the cut that is seen."""

import io
import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
import trimesh

from helpers.browser_meshes import small_burr
from helpers.installation import Installation
from helpers.visit import Visit


def take(visit: Visit, form: str) -> tuple[str, bytes]:
    """The name and the content of a download."""
    if visit.page.locator("#take-away").is_hidden():
        visit.page.click("#open-take-away")
    with visit.page.expect_download() as download:
        visit.page.click(f"[data-format='{form}']")
    return download.value.suggested_filename, Path(download.value.path()).read_bytes()


def split_one(visit: Visit) -> None:
    """Make eight parts by hand, which are not those of level eight."""
    eighth = visit.viewer("v.tree.splitNode(6)")
    other = next(p for p in visit.parts() if p != eighth and visit.viewer(f"v.tree.node({p}).children.length"))
    visit.row(other).click()
    visit.page.click("#split")
    visit.settle()


def test_each_format_has_the_parts_of_the_level(visit: Visit, job: str) -> None:
    visit.open_job(job, "&k=5")
    name, glb = take(visit, "glb")
    assert name == "burr-5.glb"
    assert len(trimesh.load_scene(io.BytesIO(glb), file_type="glb").geometry) == 5
    assert take(visit, "ply")[1].startswith(b"ply\nformat binary_little_endian")
    assert len([line for line in take(visit, "obj")[1].splitlines() if line.startswith(b"g ")]) == 5
    _, package = take(visit, "3mf")
    assert "3D/3dmodel.model" in zipfile.ZipFile(io.BytesIO(package)).namelist()
    _, archive = take(visit, "zip")
    assert len([n for n in zipfile.ZipFile(io.BytesIO(archive)).namelist() if n.endswith(".stl")]) == 5
    labels = json.loads(take(visit, "json")[1])
    assert (labels["segments"], set(labels["labels"])) == (5, set(range(5)))
    assert take(visit, "png")[1].startswith(b"\x89PNG")


def test_a_cut_by_hand_comes_out_as_it_is_seen_with_its_names(visit: Visit, job: str) -> None:
    visit.open_job(job)
    split_one(visit)
    named = visit.parts()[6]
    visit.row(named).click()
    visit.page.fill("#part-name", "Ärm")
    visit.page.keyboard.press("Enter")
    visit.settle()
    labels = json.loads(take(visit, "json")[1])
    faces = visit.viewer("v.parts.map((id) => v.tree.node(id).faces)")
    assert sorted(labels["labels"].count(k) for k in range(8)) == sorted(faces)
    by_name = dict(zip(labels["names"], (labels["labels"].count(k) for k in range(8)), strict=True))
    assert by_name["Ärm"] == visit.viewer(f"v.tree.node({named}).faces")
    scene = trimesh.load_scene(io.BytesIO(take(visit, "glb")[1]), file_type="glb")
    node = next(name for name in scene.graph.nodes_geometry if name == "Ärm")
    assert len(scene.geometry[scene.graph[node][1]].faces) == by_name["Ärm"]
    label = labels["names"].index("Ärm")
    assert f"comment label {label} is ".encode() in take(visit, "ply")[1]
    assert "g Ärm" in take(visit, "obj")[1].decode().splitlines()
    _, package = take(visit, "3mf")
    assert 'name="Ärm"' in zipfile.ZipFile(io.BytesIO(package)).read("3D/3dmodel.model").decode()
    _, archive = take(visit, "zip")
    assert f"segment_{label}_Ärm.stl" in zipfile.ZipFile(io.BytesIO(archive)).namelist()


@pytest.mark.parametrize("by_hand", [False, True])
def test_the_lines_that_are_shown_do_the_same(
    visit: Visit, installation: Installation, job: str, by_hand: bool, tmp_path: Path
) -> None:
    visit.open_job(job, "&k=6")
    if by_hand:
        visit.page.click("#level-automatic")
        split_one(visit)
    expected = json.loads(take(visit, "json")[1])["labels"]
    visit.page.wait_for_function("() => document.getElementById('python').textContent !== ''")
    (tmp_path / "burr.ply").write_bytes(small_burr())
    program = visit.page.inner_text("#python") + "\nimport json\nprint(json.dumps(labels.tolist()))"
    command = [sys.executable, "-c", program]
    environment = {"PYTHONPATH": str(Path.cwd()), "PATH": "/usr/bin:/bin"}
    printed = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    assert json.loads(printed.stdout) == expected
    lines = visit.page.inner_text("#curl").splitlines()
    subprocess.run(lines[0], shell=True, cwd=tmp_path, capture_output=True, check=True)
    fetched = subprocess.run(lines[2], shell=True, cwd=tmp_path, capture_output=True, check=True)
    assert json.loads(fetched.stdout)["labels"] == expected
    assert installation.url in lines[0]
