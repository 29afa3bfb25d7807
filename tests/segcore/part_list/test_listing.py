"""The list of parts, against trimesh and closed formulas."""

import json

import numpy as np
import pytest
import trimesh

import segcore
from helpers.part_list.copies import copy_of
from segcore import shapes
from segcore.mesh import Mesh
from segcore.part_list.document import part_list_document


def test_area_volume_and_centre_of_bodies_are_those_of_trimesh() -> None:
    rng = np.random.default_rng(0)
    bodies = [
        copy_of(shapes.icosphere(2), rng),
        copy_of(shapes.box((1.0, 2.0, 3.0)), rng),
        shapes.dumbbell(20, 16).mesh,
    ]
    joined = shapes.joined(*bodies)
    for part, body in zip(segcore.parts(joined.mesh, joined.parts).parts, bodies, strict=True):
        other = trimesh.Trimesh(body.vertices, body.faces)
        assert part.faces == len(body.faces)
        assert part.area == pytest.approx(other.area)
        assert part.volume == pytest.approx(abs(other.volume))
        np.testing.assert_allclose(part.centre, other.centroid, atol=1e-9)
        assert np.prod(part.box.extents) <= 1.05 * other.bounding_box_oriented.volume


def test_the_volumes_of_the_parts_of_a_body_add_up_to_its_volume() -> None:
    shape = shapes.burr(4)
    parts = segcore.parts(shape.mesh, shape.parts).parts
    assert sum(part.volume or 0.0 for part in parts) == pytest.approx(
        trimesh.Trimesh(shape.mesh.vertices, shape.mesh.faces).volume, rel=1e-6
    )
    assert sum(part.area for part in parts) == pytest.approx(trimesh.Trimesh(*_arrays(shape.mesh)).area)


def test_the_arms_of_a_burr_repeat() -> None:
    shape = shapes.burr(4)
    (repeat,) = segcore.parts(shape.mesh, shape.parts).repeats.groups
    assert repeat.parts == (1, 2, 3, 4, 5, 6)


def test_a_part_that_cannot_be_closed_has_a_reason() -> None:
    """Three sheets at one edge."""
    fan = Mesh([[0, 0, 0], [0, 0, 1], [1, 0, 0], [-1, 1, 0], [-1, -1, 0]], [[0, 1, 2], [0, 1, 3], [0, 1, 4]])
    dot = Mesh(np.full((3, 3), 5.0), [[0, 1, 2]])
    joined = shapes.joined(fan, dot)
    for part in segcore.parts(joined.mesh, joined.parts).parts:
        assert (part.volume is None) == (part.why_no_volume is not None)
    assert segcore.parts(joined.mesh, joined.parts).parts[1].volume is None


def test_names_are_those_that_are_given() -> None:
    two = shapes.joined(shapes.box(), shapes.box((0.5, 0.5, 0.5), (3.0, 0.0, 0.0)))
    assert [part.name for part in segcore.parts(two.mesh, two.parts, {1: "small"}).parts] == ["", "small"]


@pytest.mark.parametrize("labels", [[0] * 11, [0] * 11 + [2], [-1] * 12, [0.5] * 12])
def test_labels_that_are_none_are_refused(labels: list[float]) -> None:
    with pytest.raises(segcore.InvalidParameters):
        segcore.parts(shapes.box(), labels)


@pytest.mark.parametrize("scale", [1e-69, 1e-6, 1e6, 1e69])
def test_bodies_of_any_size_are_measured(scale: float) -> None:
    two = shapes.joined(shapes.box(), shapes.box(centre=(3.0, 0.0, 0.0)))
    listed = segcore.parts(Mesh(scale * two.mesh.vertices, two.mesh.faces), two.parts)
    assert [part.volume for part in listed.parts] == pytest.approx([scale**3] * 2, rel=1e-9)
    assert [repeat.parts for repeat in listed.repeats.groups] == [(0, 1)]


def test_coordinates_whose_areas_cannot_be_computed_are_refused() -> None:
    for scale in (1e-80, 1e80):
        with pytest.raises(segcore.InvalidParameters, match="another unit"):
            segcore.parts(Mesh(scale * shapes.box().vertices, shapes.box().faces), [0] * 12)


def test_the_document_is_json_and_refers_to_the_groups() -> None:
    shape = shapes.burr(4)
    document = part_list_document(segcore.parts(shape.mesh, shape.parts, {0: "ball"}), "millimeter", {1: "#112233"})
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    assert (document["unit"], document["parts"][0]["name"], document["parts"][1]["color"]) == (
        "millimeter",
        "ball",
        "#112233",
    )
    assert [part["repeat"] for part in document["parts"]] == [None, 0, 0, 0, 0, 0, 0]
    (repeat,) = document["repeats"]
    assert [copy["part"] for copy in repeat["copies"]] == [1, 2, 3, 4, 5, 6]
    assert repeat["copies"][0]["related_color"] == "#112233"
    assert document["repeats_complete"] is True


def _arrays(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    return mesh.vertices, mesh.faces
