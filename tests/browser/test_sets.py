"""Several files and folders: companions belong to their model, several models become several jobs."""

import json
from pathlib import Path
from typing import Any

import pytest

from helpers.browser.meshes import small_burr
from helpers.browser.visit import MAX_UPLOAD_BYTES, Visit
from helpers.files.samples import OBJ, OFF, gltf_square
from helpers.files.written import mesh_bytes
from helpers.installation import Installation
from helpers.waiting import wait_until
from segcore.shapes import burr


def written(folder: Path, files: dict[str, bytes]) -> Path:
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
    return folder


def gltf_files(mark: str) -> dict[str, bytes]:
    asset = gltf_square()
    asset.document["buffers"] = [{"byteLength": len(asset.binary), "uri": "data/the%20buffer.bin"}]
    asset.document["asset"]["generator"] = mark
    return {"scene.gltf": json.dumps(asset.document).encode(), "data/the buffer.bin": asset.binary}


def obj_files(mark: str) -> dict[str, bytes]:
    mesh = mesh_bytes(burr(3).mesh, "obj")
    library = f"newmtl red # {mark}\nmap_Kd -s 1 1 1 ..\\images\\wood grain.png\n".encode()
    return {"chair/a.obj": b"mtllib parts/my chair.mtl\n" + mesh, "chair/parts/my chair.mtl": library,
            "chair/images/wood grain.png": b"\x89PNG"}  # fmt: skip


def jobs_named(installation: Installation, name: str) -> list[dict[str, Any]]:
    jobs = installation.get("/v1/jobs?limit=100").json()["jobs"]
    return [job for job in jobs if job["input"]["file_name"] == name]


def test_a_dropped_folder_is_one_model_with_its_files(visit: Visit, tmp_path: Path, installation: Installation) -> None:
    others = {"chair/notes.txt": b"x", "chair/.DS_Store": b"x", "chair/images/unused.png": b"x", "Thumbs.db": b"x"}
    folder = written(tmp_path / "drop", obj_files("one") | others)
    visit.open()
    visit.drop_paths(folder)
    visit.page.wait_for_selector("text=Left out")
    note = visit.page.locator("#progress-note").text_content()
    assert note == "Left out, because no mesh refers to them: drop/chair/images/unused.png, drop/chair/notes.txt."
    visit.wait_for_parts()
    assert visit.page.locator("#title").inner_text() == "a.obj"
    assert len(visit.parts()) == 7
    job = installation.get(f"/v1/jobs/{visit.address('job=')['job']}").json()
    assert job["input"]["size_bytes"] > len(obj_files("one")["chair/a.obj"])


def test_a_gltf_file_and_its_buffer_can_be_chosen_together(visit: Visit, tmp_path: Path) -> None:
    visit.open()
    written(tmp_path, gltf_files("chosen"))
    visit.page.set_input_files("#folder", tmp_path)
    visit.wait_for_parts()
    assert visit.page.locator("#title").inner_text() == "scene.gltf"
    assert visit.page.locator("#about").inner_text().startswith("2 faces")


def test_several_models_become_a_list_of_jobs(visit: Visit, tmp_path: Path) -> None:
    files = obj_files("several") | gltf_files("several")
    files |= {"ball.ply": small_burr() + b"\n\n", "bad.off": b"OFF\n1", "big.stl": bytes(MAX_UPLOAD_BYTES + 1)}
    written(tmp_path, files)
    visit.open()
    visit.page.wait_for_function("() => document.getElementById('formats').textContent.includes('up to')")
    visit.drop_paths(*sorted(path for path in tmp_path.iterdir() if path.name in ("chair", *files, "data")))
    visit.page.wait_for_selector("#several-close:not([hidden])")
    rows = visit.page.locator("#several-list li")
    states = dict(
        zip(rows.evaluate_all("e => e.map((r) => r.dataset.name)"), rows.locator("span").all_inner_texts(), strict=True)
    )
    assert states["a.obj"] == states["ball.ply"] == "7 parts"
    assert states["scene.gltf"].endswith("parts") or states["scene.gltf"] == "1 part"
    assert "faces" in states["bad.off"] or "cut short" in states["bad.off"]
    assert states["big.stl"] == "Too large: 1.91 MB. This server accepts at most 1.91 MB."
    assert visit.page.locator("#several-summary").inner_text() == "3 of 5 done, 2 without a result"
    assert len([url for url in visit.requests if url.endswith("/v1/jobs")]) == 4
    visit.page.get_by_role("button", name="Open ball.ply").press("Enter")
    visit.wait_for_parts()
    assert visit.page.locator("#title").inner_text() == "ball.ply"
    visit.page.go_back()
    visit.page.wait_for_selector("#several:not([hidden])")
    visit.page.click("#several-close")
    visit.page.wait_for_selector("#start:not([hidden])")
    visit.forgive("413")


def test_a_list_can_be_stopped_and_tried_again(visit: Visit, tmp_path: Path, installation: Installation) -> None:
    written(tmp_path, {f"stop{n}.off": OFF + b"\n" * n for n in range(3)})
    visit.open()
    visit.page.route("**/v1/jobs", lambda route: None if route.request.method == "POST" else route.continue_())
    visit.drop_paths(*sorted(tmp_path.iterdir()))
    visit.page.click("#several-stop")
    assert visit.page.locator("#several-summary").inner_text() == "0 of 3 done, 3 without a result"
    visit.page.unroute_all()
    visit.page.click("#several-again")
    visit.page.wait_for_function("() => document.querySelector('#several-summary').textContent === '3 of 3 done'")
    wait_until(lambda: len(jobs_named(installation, "stop2.off")) == 1)


@pytest.mark.parametrize("names", [["notes.txt"], ["a.mtl", "b.png"]])
def test_files_without_a_mesh_are_named_and_not_sent(visit: Visit, tmp_path: Path, names: list[str]) -> None:
    written(tmp_path, dict.fromkeys(names, b"x"))
    visit.open()
    visit.drop_paths(*sorted(tmp_path.iterdir()))
    visit.page.wait_for_selector("#problem:not([hidden])")
    assert visit.page.locator("#problem-detail").inner_text() == f"{', '.join(names)}."
    assert visit.page.get_attribute("#problem", "data-code") == "no_mesh"
    assert not [url for url in visit.requests if url.endswith("/v1/jobs")]


def test_a_set_that_is_too_large_is_refused_before_it_is_sent(visit: Visit, tmp_path: Path) -> None:
    files = {"a.obj": b"mtllib a.mtl\n" + OBJ, "a.mtl": b"map_Kd t.png\n", "t.png": bytes(MAX_UPLOAD_BYTES)}
    written(tmp_path, files)
    visit.open()
    visit.page.wait_for_function("() => document.getElementById('formats').textContent.includes('up to')")
    visit.drop_paths(*sorted(tmp_path.iterdir()))
    visit.page.wait_for_selector("#problem:not([hidden])")
    assert visit.page.get_attribute("#problem", "data-code") == "too_large"
    assert "a.obj with its 2 files has 1.91 MB" in visit.page.locator("#problem-detail").inner_text()
    assert not [url for url in visit.requests if url.endswith("/v1/jobs")]
