"""The original look: colours and textures of the file, which follow the parts."""

import base64
import json
import struct
import zlib
from typing import Any

import httpx
import pytest

from helpers.browser.visit import Visit
from helpers.installation import Installation
from helpers.waiting import wait_until
from segcore.mesh import Mesh
from segcore.shapes import burr

RED, GREEN = (214, 30, 30), (30, 160, 40)


def png(color: tuple[int, int, int]) -> bytes:
    """A picture of one pixel."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(b"\0" + bytes(color)))
        + chunk(b"IEND", b"")
    )


def textured(mesh: Mesh, picture: bytes) -> list[tuple[str, bytes]]:
    """A mesh as OBJ with a picture for all faces."""
    text = ["mtllib a.mtl", "vt 0.5 0.5", "usemtl wood"]
    text += [f"v {x} {y} {z}" for x, y, z in mesh.vertices]
    text += ["f " + " ".join(f"{corner + 1}/1" for corner in face) for face in mesh.faces]
    library = "newmtl wood\nKd 1 1 1\nmap_Kd images/wood.png\n"
    return [("a.obj", "\n".join(text).encode()), ("a.mtl", library.encode()), ("images/wood.png", picture)]


@pytest.fixture(scope="module")
def red_job(installation: Installation) -> str:
    """The id of a job of a ball with six arms whose texture is red."""
    files = [("mesh", file) for file in textured(burr(4).mesh, png(RED))]
    answer = httpx.post(f"{installation.url}/v1/jobs", files=files, timeout=60)
    path = f"/v1/jobs/{answer.json()['id']}"
    wait_until(lambda: installation.status(path) == "succeeded")
    return str(answer.json()["id"])


def choose(visit: Visit, look: str) -> None:
    visit.page.evaluate(
        """() => {
          const viewer = document.getElementById('viewer');
          window.shown = new Promise((done) => viewer.addEventListener('cleave-look', (e) => done(e.detail.look)));
        }"""
    )
    visit.page.click(f"#look label:has([value={look}])")
    assert visit.page.evaluate("() => window.shown") == look
    visit.settle()


def colors(visit: Visit) -> list[list[int]]:
    places = visit.grid(12)
    return [color for part, color in zip(visit.parts_at(places), visit.colors_at(places), strict=True) if part >= 0]


def is_reddish(color: list[int]) -> bool:
    return color[0] > 1.6 * max(color[1], color[2])


def check_coverage(visit: Visit) -> None:
    """Check that the original, which is red, is drawn where the parts are and nowhere else."""
    places = visit.grid(12)
    parts, seen = visit.parts_at(places), visit.colors_at(places)
    wrong = [color for part, color in zip(parts, seen, strict=True) if (part >= 0) != (color[3] > 128)]
    assert len(wrong) < 0.03 * len(places)
    inside = [color for part, color in zip(parts, seen, strict=True) if part >= 0 and color[3] == 255]
    assert len(inside) > 50
    assert sum(map(is_reddish, inside)) > 0.95 * len(inside)


def test_the_original_look_has_the_texture_of_the_file(visit: Visit, red_job: str) -> None:
    visit.open_job(red_job)
    assert not [url for url in visit.requests if "keep=all" in url or url.endswith("/original.js")]
    of_parts = colors(visit)
    assert len([color for color in of_parts if is_reddish(color)]) < 0.5 * len(of_parts)
    choose(visit, "original")
    original = colors(visit)
    assert len([color for color in original if is_reddish(color)]) > 0.95 * len(original)
    choose(visit, "both")
    both = colors(visit)
    shares = [sum(map(is_reddish, found)) / len(found) for found in (of_parts, both, original)]
    assert shares[1] < shares[2]
    assert visit.address("look=")["look"] == "both"
    choose(visit, "parts")
    assert colors(visit) == of_parts
    assert len([url for url in visit.requests if "keep=all" in url]) == 1


def test_the_original_follows_hidden_and_moved_parts(visit: Visit, red_job: str) -> None:
    visit.open_job(red_job, "&look=original&show=nolines")
    visit.page.wait_for_function("() => !document.querySelector('#look').ariaBusy")
    visit.page.wait_for_function(
        "() => performance.getEntriesByName(`${location.origin}/viewer/original.js`).length > 0"
    )
    visit.rest()
    for state in ("explode", "hide"):
        if state == "explode":
            visit.set_range("explode", 70)
        else:
            visit.viewer("(v.hiddenParts = new Set(v.parts.slice(0, 3)))")
        visit.settle()
        check_coverage(visit)


def test_a_selected_part_stands_out_in_the_original_look(visit: Visit, red_job: str) -> None:
    visit.open_job(red_job)
    choose(visit, "original")
    part = visit.parts()[1]
    place = visit.place_of(part)
    before = visit.colors_at([place])[0]
    visit.page.mouse.click(*place)
    visit.page.mouse.move(500, 20)
    visit.page.wait_for_function("() => document.getElementById('viewer').hovered === -1")
    visit.settle()
    assert visit.selected() == [part]
    assert max(abs(a - b) for a, b in zip(visit.colors_at([place])[0], before, strict=True)) < 40
    others = [
        color
        for other, color in zip(visit.parts_at(visit.grid(16)), visit.colors_at(visit.grid(16)), strict=True)
        if other not in (-1, part)
    ]
    assert sum(map(is_reddish, others)) < 0.2 * len(others)


def test_the_look_can_be_chosen_by_keyboard(visit: Visit, red_job: str) -> None:
    visit.open_job(red_job)
    visit.page.focus("#viewer")
    visit.page.keyboard.press("o")
    visit.page.wait_for_function("() => document.querySelector('#announcer').textContent === 'Look: original.'")
    visit.page.focus("#look [value=original]")
    visit.page.keyboard.press("ArrowRight")
    assert visit.address("look=both")["look"] == "both"
    visit.page.reload()
    visit.wait_for_parts()
    assert visit.page.is_checked("#look [value=both]")


def test_a_missing_original_is_explained(visit: Visit, job: str) -> None:
    problem = {"code": "input_lost", "detail": "The file is no longer there.", "status": 410}
    visit.page.route("**/model.glb?*keep=all*", lambda route: route.fulfill(status=410, json=problem))
    visit.open_job(job)
    visit.page.click("#look label:has([value=original])")
    visit.page.wait_for_selector(".toast:has-text('The file is no longer there.')")
    visit.page.wait_for_function("() => document.querySelector('#look [value=parts]').checked")
    visit.forgive("410")


def copies() -> bytes:
    """Two copies of a shape as two nodes that share everything, as a glTF file."""
    mesh = burr(2).mesh
    positions, indices = mesh.vertices.astype("<f4").tobytes(), mesh.faces.astype("<u4").tobytes()
    views = [{"byteLength": len(positions)}, {"byteOffset": len(positions), "byteLength": len(indices)}]
    ends = {"min": mesh.vertices.min(axis=0).tolist(), "max": mesh.vertices.max(axis=0).tolist()}
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [7, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.6, 0.01, 0.01, 1], "metallicFactor": 0}}],
        "buffers": [{"uri": "data:;base64," + base64.b64encode(positions + indices).decode()}],
        "bufferViews": [{"buffer": 0, **view} for view in views],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(mesh.vertices), "type": "VEC3", **ends},
            {"bufferView": 1, "componentType": 5125, "count": mesh.faces.size, "type": "SCALAR"},
        ],
    }
    document["buffers"][0]["byteLength"] = len(positions + indices)
    return json.dumps(document).encode()


def test_copies_that_share_their_geometry_are_told_apart(visit: Visit) -> None:
    visit.open()
    visit.drop("copies.gltf", copies())
    visit.wait_for_parts()
    choose(visit, "original")
    visit.set_range("explode", 60)
    visit.settle()
    check_coverage(visit)
