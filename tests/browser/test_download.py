"""Downloads contain the parts that the page shows."""

import io
import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
import trimesh

from helpers.browser.meshes import small_burr
from helpers.browser.visit import Visit
from helpers.installation import Installation


def download_as(visit: Visit, form: str) -> tuple[str, bytes]:
    """Return the name and the content of a download."""
    if visit.page.locator("#download").is_hidden():
        visit.page.click("#open-download")
    with visit.page.expect_download() as download:
        visit.page.click(f"[data-format='{form}']")
    return download.value.suggested_filename, Path(download.value.path()).read_bytes()


def split_one(visit: Visit) -> None:
    """Split a part by hand, so that the eight parts are not those of level eight."""
    eighth = visit.viewer("v.tree.splitNode(6)")
    other = next(p for p in visit.parts() if p != eighth and visit.viewer(f"v.tree.node({p}).children.length"))
    visit.row(other).click()
    visit.page.click("#split")
    visit.settle()


def test_each_format_has_the_parts_of_the_level(visit: Visit, job: str) -> None:
    visit.open_job(job, "&k=5")
    name, glb = download_as(visit, "glb")
    assert name == "burr-5.glb"
    assert len(trimesh.load_scene(io.BytesIO(glb), file_type="glb").geometry) == 5
    assert download_as(visit, "ply")[1].startswith(b"ply\nformat binary_little_endian")
    assert len([line for line in download_as(visit, "obj")[1].splitlines() if line.startswith(b"o ")]) == 5
    name, both = download_as(visit, "objzip")
    assert name == "burr-5.obj.zip"
    assert zipfile.ZipFile(io.BytesIO(both)).namelist() == ["model.obj", "model.mtl"]
    _, package = download_as(visit, "3mf")
    assert "3D/3dmodel.model" in zipfile.ZipFile(io.BytesIO(package)).namelist()
    name, archive = download_as(visit, "zip")
    assert name == "burr-5-parts.zip"
    listed = json.loads(zipfile.ZipFile(io.BytesIO(archive)).read("parts.json"))
    assert [part["closed"] for part in listed["parts"]] == [True] * 5
    labels = json.loads(download_as(visit, "json")[1])
    assert (labels["segments"], set(labels["labels"])) == (5, set(range(5)))
    assert download_as(visit, "png")[1].startswith(b"\x89PNG")


def test_downloads_have_the_parts_of_a_manual_cut_and_their_names(visit: Visit, job: str) -> None:
    visit.open_job(job)
    split_one(visit)
    named = visit.parts()[6]
    visit.row(named).click()
    visit.page.fill("#part-name", "Ärm")
    visit.page.keyboard.press("Enter")
    visit.settle()
    labels = json.loads(download_as(visit, "json")[1])
    faces = visit.viewer("v.parts.map((id) => v.tree.node(id).faces)")
    assert sorted(labels["labels"].count(k) for k in range(8)) == sorted(faces)
    by_name = dict(zip(labels["names"], (labels["labels"].count(k) for k in range(8)), strict=True))
    assert by_name["Ärm"] == visit.viewer(f"v.tree.node({named}).faces")
    scene = trimesh.load_scene(io.BytesIO(download_as(visit, "glb")[1]), file_type="glb")
    node = next(name for name in scene.graph.nodes_geometry if name == "Ärm")
    assert len(scene.geometry[scene.graph[node][1]].faces) == by_name["Ärm"]
    label = labels["names"].index("Ärm")
    assert f"comment label {label} is ".encode() in download_as(visit, "ply")[1]
    assert "o Ärm" in download_as(visit, "obj")[1].decode().splitlines()
    _, package = download_as(visit, "3mf")
    assert 'name="Ärm"' in zipfile.ZipFile(io.BytesIO(package)).read("3D/3dmodel.model").decode()
    _, archive = download_as(visit, "zip")
    assert f"segment_{label}_Ärm.stl" in zipfile.ZipFile(io.BytesIO(archive)).namelist()


@pytest.mark.parametrize("by_hand", [False, True])
def test_the_code_that_is_shown_gives_the_same_labels(
    visit: Visit, installation: Installation, job: str, by_hand: bool, tmp_path: Path
) -> None:
    visit.open_job(job, "&k=6")
    if by_hand:
        visit.page.click("#level-automatic")
        split_one(visit)
    expected = json.loads(download_as(visit, "json")[1])["labels"]
    visit.page.wait_for_function("() => document.getElementById('python').textContent !== ''")
    (tmp_path / "burr.ply").write_bytes(small_burr())
    shown = visit.page.inner_text("#python")
    program = shown + "\nimport json\nprint(json.dumps(labels.tolist()))"
    command = [sys.executable, "-c", program]
    environment = {"PYTHONPATH": str(Path.cwd()), "PATH": "/usr/bin:/bin"}
    printed = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    assert json.loads(printed.stdout) == expected
    visit.page.keyboard.press("Escape")
    visit.page.click("[data-tool=brush]")
    visit.page.evaluate("() => document.getElementById('python').replaceChildren()")
    visit.page.click("#open-download")
    visit.page.wait_for_function("() => document.getElementById('python').textContent !== ''")
    assert visit.page.inner_text("#python") == shown
    lines = visit.page.inner_text("#curl").splitlines()
    subprocess.run(lines[0], shell=True, cwd=tmp_path, capture_output=True, check=True)
    fetched = subprocess.run(lines[2], shell=True, cwd=tmp_path, capture_output=True, check=True)
    assert json.loads(fetched.stdout)["labels"] == expected
    assert installation.url in lines[0]
