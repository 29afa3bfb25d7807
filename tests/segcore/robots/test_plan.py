"""Parts as links: masses, places, joints, and convex pieces."""

import sys

import numpy as np
import pytest
import trimesh

from helpers.printing.bars import bar, bent_bar
from helpers.printing.solids import halves, pipe
from helpers.simulation.shapes import angle
from segcore.coordinates import Coordinates
from segcore.errors import InvalidParameters, MissingPackage
from segcore.mesh import Mesh
from segcore.partition import Partition
from segcore.robots.options import RobotOptions
from segcore.robots.plan import RobotPlan, plan_robot

HULL = RobotOptions(collision="hull")
HINGES = RobotOptions(collision="hull", joints="hinge")
METRES = Coordinates("meter", "z")


def tall(*shapes: trimesh.Trimesh) -> Mesh:
    joined = trimesh.util.concatenate(list(shapes))
    return Mesh(joined.vertices, joined.faces, coordinates=METRES)


def box(low: tuple[float, ...], high: tuple[float, ...]) -> trimesh.Trimesh:
    return trimesh.creation.box(bounds=[low, high])


def test_mass_and_inertia_are_those_of_the_solids() -> None:
    plan = plan_robot(*bar(), options=RobotOptions(collision="hull", density=500.0), names={0: "upper arm"})
    assert plan.scale == 1.0
    assert [link.name for link in plan.links] == ["upper_arm", "segment_1"]
    for link in plan.links:
        found = link.body.properties
        assert found is not None
        x, y, z = 0.03, 0.02, 0.02
        assert found.mass == pytest.approx(500 * x * y * z)
        moments = found.mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
        assert found.inertia == pytest.approx(np.diag(moments), abs=1e-9 * moments.max())
        assert abs(found.centre) == pytest.approx([0.015, 0.0, 0.01], abs=1e-12)


def test_the_whole_stands_on_the_plane_with_z_up_at_the_requested_length() -> None:
    mesh, hierarchy = bar(coordinates=Coordinates("millimeter", "y"))
    plan = plan_robot(mesh, hierarchy, options=RobotOptions(collision="hull", length=3.0))
    points = np.concatenate([link.body.shape.vertices for link in plan.links])
    assert points.min(axis=0) == pytest.approx([-1.5, -0.5, 0.0])
    assert points.max(axis=0) == pytest.approx([1.5, 0.5, 1.0])
    assert plan.scale == pytest.approx(50.0)
    assert plan.links[0].origin == pytest.approx([0, 0, 0], abs=1e-12)
    assert plan.links[1].origin == pytest.approx([0, 0, 0.5], abs=1e-9)


def test_links_come_after_their_parents_the_largest_part_first() -> None:
    boxes = [box((x, 0, 0), (x + size, 1, 1)) for x, size in ((0, 1), (1.5, 3), (5, 2), (9, 1))]
    mesh = tall(*boxes)
    plan = plan_robot(mesh, Partition(np.arange(4).repeat(12)).hierarchy(mesh), options=HINGES)
    assert plan.links[0].label == 1
    parents = {link.label: plan.links[link.joint.parent].label for link in plan.links if link.joint}
    assert parents == {0: 1, 2: 1, 3: 2}  # the nearest ones
    assert {link.joint.reason for link in plan.links if link.joint} == {"the parts have no common border"}


def reasons(plan: RobotPlan) -> list[str | None]:
    return [link.joint.reason for link in plan.links if link.joint]


def test_a_hinge_is_at_a_plane_border_that_is_the_only_one() -> None:
    plan = plan_robot(*bar(), options=HINGES)
    (joint,) = [link.joint for link in plan.links if link.joint]
    assert (joint.kind, joint.reason) == ("hinge", None)
    assert joint.axis is not None
    assert abs(joint.axis) == pytest.approx([1, 0, 0])
    assert plan.links[1].origin == pytest.approx([0, 0, 0.01], abs=1e-9)
    assert reasons(plan_robot(*bent_bar(), options=HINGES)) == ["the border is not plane"]
    ring = pipe(16)
    along = plan_robot(ring, halves(ring, ring.corners[:, :, 0].mean(axis=1) < 0), options=HINGES)
    assert reasons(along) == ["the parts touch at 2 places"]


def test_parts_in_a_circle_of_contacts_cannot_turn() -> None:
    ring = pipe(24)
    turn = np.arctan2(*ring.corners.mean(axis=1)[:, :2].T)
    third = np.floor((turn + np.pi) / (2 * np.pi) * 3).clip(0, 2).astype(np.int32)
    plan = plan_robot(ring, Partition(third).hierarchy(ring), options=HINGES)
    assert reasons(plan) == ["other contacts join the parts as well"] * 2
    assert len(plan.touching) == 3


def test_a_part_that_is_not_convex_gets_convex_pieces() -> None:
    part = angle()
    (hull,) = plan_robot(*part, options=HULL).links[0].body.pieces
    pieces = plan_robot(*part).links[0].body.pieces
    solids = [trimesh.Trimesh(piece.vertices, piece.faces) for piece in pieces]
    assert 2 <= len(solids) <= 4
    assert all(solid.is_convex for solid in solids)
    assert sum(solid.volume for solid in solids) == pytest.approx(
        trimesh.Trimesh(part[0].vertices, part[0].faces).volume, rel=0.1
    )
    assert trimesh.Trimesh(hull.vertices, hull.faces).volume > 2
    few = RobotOptions(pieces=1)
    assert len(plan_robot(*part, options=few).links[0].body.pieces) == 1


def test_parts_without_a_volume_have_a_note() -> None:
    bent = trimesh.Trimesh([[0, 0, 0], [0, 0, 1], [1, 0, 0.5], [-1, 0.5, 0.5]], [[0, 1, 2], [0, 3, 1]])
    sheet = trimesh.Trimesh([[5, 0, 0], [6, 0, 0], [6, 1, 0], [5, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    mesh = tall(bent, sheet)
    labels = np.array([0, 1]).repeat(2)
    plan = plan_robot(mesh, Partition(labels).hierarchy(mesh), options=HULL)
    bodies = {link.label: link.body for link in plan.links}
    folded, flat = bodies[0], bodies[1]
    assert (flat.properties, flat.pieces) == (None, [])
    assert flat.note is not None
    assert "flat" in flat.note
    assert folded.note is not None
    assert "encloses no volume" in folded.note
    assert folded.properties is not None
    assert folded.properties.volume == pytest.approx(bent.convex_hull.volume)


def test_a_part_at_which_the_library_fails_is_its_hull(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("segcore.robots.convex.sys.executable", "false")
    (link,) = plan_robot(*angle()).links
    assert len(link.body.pieces) == 1
    assert link.body.is_closed
    assert link.body.note is not None
    assert "CoACD failed" in link.body.note


def test_a_mesh_of_flat_parts_is_refused() -> None:
    sheet = tall(trimesh.Trimesh([[5, 0, 0], [6, 0, 0], [6, 1, 0]], [[0, 1, 2]]))
    with pytest.raises(InvalidParameters, match="flat"):
        plan_robot(sheet, Partition(np.zeros(1, dtype=np.int32)).hierarchy(sheet))


def test_only_convex_pieces_need_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "coacd", None)
    part = angle()
    assert plan_robot(*part, options=HULL).links
    with pytest.raises(MissingPackage, match=r"cleave-mesh\[robot\]"):
        plan_robot(*part)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"joints": "ball"}, "joints must be one of fixed, hinge"),
        ({"collision": "mesh"}, "collision must be one of"),
        ({"concavity": 0.0}, "concavity must be from 0.01 to 1"),
        ({"pieces": 65}, "pieces must be from 1 to 64"),
        ({"density": float("nan")}, "density must be above 0"),
        ({"length": 0.0}, "length must be above 0"),
    ],
)
def test_values_outside_their_range_are_refused(options: dict[str, object], words: str) -> None:
    with pytest.raises(InvalidParameters, match=words):
        RobotOptions(**options)


def test_a_mesh_that_is_too_large_asks_for_a_length() -> None:
    mesh, hierarchy = bar(length=1e8)
    with pytest.raises(InvalidParameters, match="give a length"):
        plan_robot(mesh, hierarchy, options=HULL)
