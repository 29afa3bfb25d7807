"""Parts as solids with connectors: volumes, clearances, and contacts that have no room for one."""

import sys

import numpy as np
import pytest
import trimesh

from helpers.printing.bars import IN_MM, bar, bent_bar
from helpers.printing.solids import halves, pipe, volume
from segcore.coordinates import Coordinates
from segcore.errors import InvalidParameters, MissingPackage
from segcore.mesh import Mesh
from segcore.printing.booleans import solid_of
from segcore.printing.options import PrintOptions
from segcore.printing.plan import Piece, PrintPlan, plan_print
from segcore.printing.report import print_report

SIDES = 64
CLEARANCE = 0.3


def prism(radius: float, height: float) -> float:
    """The volume of a prism with 64 sides."""
    return 0.5 * SIDES * radius**2 * np.sin(2 * np.pi / SIDES) * height


def planned(kind: str, **options: object) -> PrintPlan:
    return plan_print(*bar(), options=PrintOptions(connectors=kind, clearance=CLEARANCE, **options))


def overlap(one: Piece, other: Piece) -> float:
    solids = [solid_of(piece.vertices, piece.faces) for piece in (one, other)]
    return float((solids[0] ^ solids[1]).volume())


def distances(piece: Piece) -> np.ndarray:
    """The distances from the axis of the bar of the vertices that are neither on its faces nor on the contact."""
    is_inside = ((piece.vertices > 1e-6) & (piece.vertices < [60.0 - 1e-6, 20.0 - 1e-6, 20.0 - 1e-6])).all(axis=1)
    inner = piece.vertices[is_inside & (np.abs(piece.vertices[:, 0] - 30.0) > 1.0)]
    return np.linalg.norm(inner[:, 1:] - 10.0, axis=1)


def test_volumes_are_those_of_the_parts_plus_pegs_minus_holes() -> None:
    plan = planned("peg")
    (joint,) = plan.joints
    connector = joint.connector
    assert connector is not None
    added = prism(connector.radius, connector.depth)
    removed = prism(connector.hole_radius, connector.hole_depth)
    found = sorted(volume(piece.vertices, piece.faces) for piece in plan.pieces)
    assert found == pytest.approx(sorted([12_000.0 + added, 12_000.0 - removed]), rel=1e-6)
    assert found == pytest.approx(sorted(float(piece.volume or 0) for piece in plan.pieces), rel=1e-9)


def test_dowels_are_objects_of_their_own_and_leave_a_hole_in_both_parts() -> None:
    plan = planned("dowel")
    one, other, dowel = plan.pieces
    connector = plan.joints[0].connector
    assert connector is not None
    removed = prism(connector.hole_radius, connector.hole_depth)
    assert [one.volume, other.volume] == pytest.approx([12_000.0 - removed] * 2, rel=1e-6)
    assert (dowel.name, dowel.label) == ("dowel 1", None)
    assert dowel.volume == pytest.approx(prism(connector.radius, 2 * connector.depth), rel=1e-6)


@pytest.mark.parametrize("kind", ["peg", "dowel"])
def test_a_hole_is_wider_and_deeper_than_what_fits_into_it_by_the_clearance(kind: str) -> None:
    plan = planned(kind)
    connector = plan.joints[0].connector
    assert connector is not None
    radii = np.unique(np.concatenate([distances(piece) for piece in plan.pieces]).round(5))
    fitting, hole = radii
    assert 2 * (hole - fitting) * np.cos(np.pi / SIDES) == pytest.approx(CLEARANCE, abs=4e-5)
    assert connector.hole_depth - connector.depth == pytest.approx(CLEARANCE / 2)
    pairs = [(a, b) for a in range(len(plan.pieces)) for b in range(a)]
    assert [overlap(plan.pieces[a], plan.pieces[b]) for a, b in pairs] == pytest.approx([0.0] * len(pairs), abs=1e-6)


def test_a_connector_is_in_the_middle_of_the_contact_and_has_half_its_width() -> None:
    contact = print_report(planned("peg"))["contacts"][0]
    assert contact["connector"]["centre"] == pytest.approx([30.0, 10.0, 10.0], abs=1e-4)
    assert contact["circle_diameter"] == pytest.approx(20.0, rel=0.03)
    assert contact["connector"]["diameter"] == pytest.approx(10.0, rel=0.03)
    assert contact["area"] == pytest.approx(400.0)
    assert contact["deviation"] == pytest.approx(0.0, abs=1e-9)


def test_the_wall_of_a_pipe_is_one_contact_and_too_thin_for_a_connector() -> None:
    mesh = pipe()
    hierarchy = halves(mesh, mesh.corners[:, :, 2].mean(axis=1) > 0.01)
    (contact,) = print_report(plan_print(mesh, hierarchy, options=PrintOptions(size=80.0)))["contacts"]
    assert contact["circle_diameter"] == pytest.approx(4.0, rel=0.05)  # radii of 16 and 20 mm
    assert "small" in contact["reason"]
    (contact,) = print_report(plan_print(mesh, hierarchy, options=PrintOptions(size=100.0)))["contacts"]
    assert contact["reason"].startswith("the wall is thin")


def test_two_parts_that_touch_twice_have_two_connectors() -> None:
    ring = trimesh.creation.torus(major_radius=40.0, minor_radius=8.0, major_sections=32, minor_sections=32)
    mesh = Mesh(ring.vertices, ring.faces, coordinates=IN_MM)
    plan = plan_print(
        mesh, halves(mesh, mesh.corners[:, :, 1].mean(axis=1) > 0), options=PrintOptions(connectors="peg")
    )
    contacts = print_report(plan)["contacts"]
    assert [contact["connector"]["holes"] for contact in contacts] == [1, 1]
    centres = np.array([contact["connector"]["centre"] for contact in contacts])
    assert np.ptp(centres, axis=0) == pytest.approx([80.0, 0.0, 0.0], abs=1e-3)
    assert [contact["area"] for contact in contacts] == pytest.approx([np.pi * 64.0] * 2, rel=0.01)


def test_a_contact_that_is_not_nearly_plane_has_no_connector_and_the_reason() -> None:
    (contact,) = print_report(plan_print(*bent_bar()))["contacts"]
    assert contact["connector"] is None
    assert "plane" in contact["reason"]


def test_without_connectors_volumes_stay() -> None:
    plan = planned("none")
    assert [piece.volume for piece in plan.pieces] == pytest.approx([12_000.0] * 2)
    assert plan.joints[0].connector is None


def test_an_open_part_is_closed_and_a_flat_one_is_written_without_connectors() -> None:
    mesh, hierarchy = bar()
    faces = mesh.faces[mesh.corners[:, :, 0].min(axis=1) > 1e-9]  # without one end
    kept = hierarchy.face_leaf[mesh.corners[:, :, 0].min(axis=1) > 1e-9]
    plan = plan_print(Mesh(mesh.vertices, faces, coordinates=IN_MM), halves(Mesh(mesh.vertices, faces), kept == 1))
    assert all(piece.volume for piece in plan.pieces)
    flat = mesh.corners[:, :, 0].max(axis=1) < 1e-9
    report = print_report(plan_print(mesh, halves(mesh, flat)))
    assert [one["closed"] for one in report["objects"]] == [False, True]
    assert [contact["reason"] for contact in report["contacts"]] == ["a part is not a closed solid"]


def test_lengths_are_millimetres_with_z_up_and_a_size_scales_them() -> None:
    inches = plan_print(*bar(coordinates=Coordinates("inch", "y")), options=PrintOptions(connectors="none"))
    corners = np.concatenate([piece.vertices for piece in inches.pieces])
    assert [corners.min(axis=0), corners.max(axis=0)] == pytest.approx(
        np.array([[0, 0, 0], [1524, 508, 508]]), abs=1e-9
    )
    unknown = print_report(plan_print(*bar(coordinates=Coordinates()), options=PrintOptions(size=30.0)))
    assert (unknown["unit_of_mesh"], unknown["scale"]) == (None, pytest.approx(0.5))
    assert unknown["volume"] == pytest.approx(3000.0)


def test_a_whole_that_no_printer_makes_is_refused() -> None:
    with pytest.raises(InvalidParameters, match="give a size"):
        plan_print(*bar(length=3e5))


def test_without_manifold3d_the_error_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    with pytest.raises(MissingPackage, match=r"pip install 'cleave-mesh\[print\]'"):
        plan_print(*bar())


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"connectors": "screw"}, "connectors must be one of none, dowel, peg"),
        ({"clearance": -0.1}, "clearance"),
        ({"clearance": float("nan")}, "clearance"),
        ({"bed": "250x250"}, "bed must be three lengths"),
        ({"bed": "20x250x250"}, "at least 50 mm"),
        ({"bed": "250x250x250\n"}, "bed must be three lengths"),
        ({"slots": 0}, "slots"),
        ({"size": float("inf")}, "size"),
        ({"slicer": "other"}, "slicer must be one of"),
    ],
)
def test_values_out_of_range_are_refused(values: dict[str, object], message: str) -> None:
    with pytest.raises(InvalidParameters, match=message):
        PrintOptions(**values)
