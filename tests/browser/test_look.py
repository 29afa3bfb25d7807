"""The thing as it is: flat faces flat and round ones round, the right axis up, sizes with their unit."""

import itertools

import numpy as np

from helpers.browser.visit import Visit
from helpers.files.samples import gltf_square, threemf_square
from helpers.files.written import mesh_bytes
from segcore.mesh import Mesh


def prism(sides: int, height: float = 2.0) -> Mesh:
    """A prism along z with a radius of 1, whose ends are fans."""
    turn = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    points = np.concatenate(
        [np.c_[ring, np.zeros(sides)], np.c_[ring, np.full(sides, height)], [[0, 0, 0], [0, 0, height]]]
    )
    here, there = np.arange(sides), (np.arange(sides) + 1) % sides
    sides_of = np.concatenate([np.c_[here, there, there + sides], np.c_[here, there + sides, here + sides]])
    ends = np.concatenate([np.c_[there, here, np.full(sides, 2 * sides)], np.c_[here, there, np.full(sides, 0)]])
    ends[sides:] = np.c_[here + sides, there + sides, np.full(sides, 2 * sides + 1)]
    return Mesh(points, np.concatenate([sides_of, ends]).astype(np.int32))


def shades(visit: Visit) -> list[list[int]]:
    """The sums of red, green and blue of many points of the picture, in groups with gaps between them."""
    visit.page.click("#lines")
    visit.settle()
    places = visit.grid(8)
    found = zip(visit.parts_at(places), visit.colors_at(places), strict=True)
    sums = sorted(sum(color[:3]) for part, color in found if part >= 0)
    assert len(sums) > 200
    borders = [i for i in range(1, len(sums)) if sums[i] - sums[i - 1] > 8]
    return [sums[begin:end] for begin, end in itertools.pairwise([0, *borders, len(sums)]) if end - begin > 3]


def show(visit: Visit, name: str, data: bytes) -> None:
    """Show a file as one part."""
    visit.open()
    visit.drop(name, data)
    visit.wait_for_parts()
    visit.set_range("level", 1)


def test_each_flat_face_has_one_shade(visit: Visit) -> None:
    show(visit, "prism.off", mesh_bytes(prism(8), "off"))
    groups = shades(visit)
    assert 3 <= len(groups) <= 6
    assert (
        max(group[-1] - group[0] for group in groups) < 40
    )  # the camera is near, so the light of a face is not quite the same everywhere


def test_round_faces_have_no_steps_of_shade(visit: Visit) -> None:
    show(visit, "cylinder.off", mesh_bytes(prism(36), "off"))
    groups = shades(visit)
    assert len(groups) <= 2  # the side and an end
    assert max(group[-1] - group[0] for group in groups) > 100


def test_normals_of_the_file_are_used(visit: Visit) -> None:
    """A box whose normals are those of a ball looks round."""
    box = prism(4)
    points = [f"v {x} {y} {z}" for x, y, z in box.vertices]
    normals = [f"vn {x} {y} {z}" for x, y, z in box.vertices - [0, 0, 1]]
    faces = ["f " + " ".join(f"{corner + 1}//{corner + 1}" for corner in face) for face in box.faces]
    show(visit, "ball.obj", "\n".join([*points, *normals, *faces]).encode())
    assert len(shades(visit)) == 1


def test_the_axis_that_a_format_usually_has_points_up(visit: Visit) -> None:
    for name, up in (("tall.stl", "z"), ("tall.ply", "y")):
        show(visit, name, mesh_bytes(prism(12, 9.0), name[-3:]))
        assert visit.page.get_attribute("#viewer", "up") == up
        assert visit.page.get_attribute("#up", "aria-pressed") == str(up == "z").lower()
        assert "up=" not in visit.page.url
        box = extent(visit)
        assert (box[1] > 2 * box[0]) == (up == "z")
        visit.page.click("#up")
        other = "y" if up == "z" else "z"
        assert visit.address("up=")["up"] == other
        visit.page.reload()
        visit.wait_for_parts()
        assert visit.page.get_attribute("#viewer", "up") == other


def test_sizes_are_shown_with_their_unit(visit: Visit) -> None:
    sizes = {
        "size.off": (mesh_bytes(prism(12, 9.0), "off"), "2 2 9"),
        "size.3mf": (threemf_square(), "1 1 0.5 mm"),
        "size.glb": (gltf_square().glb(), "1 1 0.5 m"),
    }
    for name, (data, size) in sizes.items():
        show(visit, name, data)
        facts = visit.page.locator("#about").inner_text().replace(" \u00d7", "").split(" \u00b7 ")
        assert size in facts


def extent(visit: Visit) -> tuple[float, float]:
    """Width and height of what the picture shows, in pixels."""
    places = visit.grid(8)
    seen = [place for place, part in zip(places, visit.parts_at(places), strict=True) if part >= 0]
    xs, ys = zip(*seen, strict=True)
    return max(xs) - min(xs), max(ys) - min(ys)
