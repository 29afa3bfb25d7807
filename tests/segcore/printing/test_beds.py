"""Parts that are larger than the bed."""

import numpy as np
import pytest

from helpers.bodies.creatures import creature
from helpers.printing.bars import bar
from helpers.printing.solids import volume
from segcore.method import segment
from segcore.parameters import SegmentationParameters
from segcore.printing.fitting import fitted_level
from segcore.printing.options import PrintOptions
from segcore.printing.plan import plan_print
from segcore.printing.report import print_report


@pytest.mark.parametrize("kind", ["none", "dowel", "peg"])
def test_every_piece_fits_the_bed_and_volumes_add_up(kind: str) -> None:
    options = PrintOptions(connectors=kind, bed="100x60x60", clearance=0.4)
    plan = plan_print(*bar(length=500.0), options=options)
    report = print_report(plan)
    assert all(one["fits_bed"] for one in report["objects"])
    pieces = [piece for piece in plan.pieces if piece.label is not None]
    assert len(pieces) >= 6
    joined = [contact["connector"] for contact in report["contacts"] if contact["connector"]]
    assert len(joined) == (0 if kind == "none" else len(pieces) - 1)
    area = {
        key: [32 * (one[key] / 2) ** 2 * np.sin(2 * np.pi / 64) for one in joined]
        for key in ("diameter", "hole_diameter")
    }
    holes = sum(a * one["hole_depth"] * one["holes"] for a, one in zip(area["hole_diameter"], joined, strict=True))
    pegs = sum(a * one["depth"] for a, one in zip(area["diameter"], joined, strict=True)) if kind == "peg" else 0.0
    found = sum(volume(piece.vertices, piece.faces) for piece in pieces)
    assert found == pytest.approx(500.0 * 400.0 + pegs - holes, rel=1e-5)


def test_pieces_of_a_part_are_numbered() -> None:
    plan = plan_print(*bar(length=300.0), options=PrintOptions(connectors="none", bed="100x100x100"), names={1: "tail"})
    assert [piece.name for piece in plan.pieces] == ["segment 0 1", "segment 0 2", "tail 1", "tail 2"]
    assert [contact["pieces"] for contact in print_report(plan)["contacts"]] == [None, [1, 2], [1, 2]]


def test_a_part_is_divided_into_a_limited_number_of_pieces() -> None:
    plan = plan_print(*bar(length=9_000.0), options=PrintOptions(connectors="none", bed="50x50x50"))
    assert len(plan.pieces) <= 2 * 64
    assert not all(one["fits_bed"] for one in print_report(plan)["objects"])


def test_the_hierarchy_divides_a_part_before_planes_do() -> None:
    mesh, hierarchy = bar(length=90.0)
    options = PrintOptions(connectors="dowel", bed="50x50x50")
    plan = plan_print(mesh, hierarchy, 1, options, names={0: "arm"})
    assert [piece.name for piece in plan.pieces] == ["arm 1", "arm 2", "dowel 1"]
    assert [piece.label for piece in plan.pieces] == [0, 0, None]
    (contact,) = print_report(plan)["contacts"]
    assert (contact["parts"], contact["pieces"]) == ([0, 0], [1, 2])
    level = fitted_level(hierarchy, 1, mesh.corners, np.array([50.0, 50.0, 50.0]))
    assert np.array_equal(level.labels, hierarchy.labels(2))
    too_small = fitted_level(hierarchy, 1, mesh.corners, np.array([30.0, 50.0, 50.0]))
    assert np.array_equal(too_small.labels, hierarchy.labels(1))  # planes divide it


def test_a_level_is_fitted_part_by_part() -> None:
    mesh = creature(subdivisions=3)
    hierarchy = segment(mesh, SegmentationParameters(max_segments=12))
    room = np.ptp(mesh.vertices, axis=0) * 0.6
    level = fitted_level(hierarchy, 2, mesh.corners, room)
    coarse = hierarchy.labels(2)
    assert all(len(set(coarse[level.labels == piece])) == 1 for piece in range(len(level.part)))
    assert [int(coarse[level.labels == piece][0]) for piece in range(len(level.part))] == level.part
    divided = {part for part in level.part if level.part.count(part) > 1}
    for piece, part in enumerate(level.part):
        corners = mesh.corners[level.labels == piece].reshape(-1, 3)
        assert part not in divided or (np.ptp(corners, axis=0) <= room).all()
    assert divided
