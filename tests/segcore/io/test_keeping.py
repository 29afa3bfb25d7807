"""The file that was segmented is checked before it is divided, and options that it does not have are refused."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.files.kept import kept
from helpers.files.rich_gltf import rich_asset
from helpers.files.samples import gltf_square
from helpers.files.written import members, written
from helpers.hierarchies import hierarchy_of_labels
from segcore.errors import InvalidMesh, InvalidParameters, LimitExceeded
from segcore.io import Original, ReadLimits, read_mesh, write_kept
from segcore.mesh import Mesh

SQUARE = gltf_square().glb()
HALVES = hierarchy_of_labels(np.array([0, 1]))


def test_a_file_with_another_number_of_faces_is_refused() -> None:
    with pytest.raises(InvalidMesh, match=r"358 faces, and 2 were segmented.*Segment it again"):
        kept(rich_asset().glb(), HALVES)


@pytest.mark.parametrize(
    ("vertices", "faces"),
    [
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.01]], [[0, 1, 2], [0, 2, 3]]),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 2, 3], [0, 1, 2]]),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [9, 9, 9]], [[0, 1, 2], [0, 2, 3]]),
    ],
    ids=["moved", "another order", "another vertex"],
)
def test_a_file_with_other_faces_or_vertices_is_refused(vertices: list[Any], faces: list[Any]) -> None:
    assert kept(SQUARE, HALVES, mesh=read_mesh(io.BytesIO(SQUARE)))
    with pytest.raises(InvalidMesh, match="others than those that were segmented"):
        kept(SQUARE, HALVES, mesh=Mesh(vertices, faces))


def test_limits_hold_and_levels_exist() -> None:
    with pytest.raises(LimitExceeded, match="max_faces"):
        write_kept(io.BytesIO(), Original(io.BytesIO(SQUARE), limits=ReadLimits(max_faces=1)), HALVES)
    with pytest.raises(InvalidParameters, match="1 to 2"):
        kept(SQUARE, HALVES, 3)


def test_the_writers_take_the_file_that_was_segmented(tmp_path: Path) -> None:
    mesh, path = read_mesh(io.BytesIO(SQUARE)), tmp_path / "square.glb"
    path.write_bytes(SQUARE)
    assert written("glb", mesh, HALVES, keep=Original(path)) == kept(SQUARE, HALVES)
    assert list(members(written("zip", mesh, HALVES, part_format="glb", keep=Original(path)))) == [
        "segment_0.glb",
        "segment_1.glb",
    ]


@pytest.mark.parametrize(
    ("kind", "options", "message"),
    [
        ("glb", {"features": True}, "no option features"),
        ("glb", {"layout": "flat"}, "no option layout"),
        ("zip", {"part_format": "obj"}, "choose glb"),
        ("zip", {"part_format": "glb", "unit": "mm"}, "unit cannot be chosen"),
        ("zip", {"part_format": "dae"}, "stl or obj or glb"),
    ],
)
def test_options_that_contradict_each_other_are_refused(kind: str, options: dict[str, Any], message: str) -> None:
    keep = {} if options.get("part_format") == "dae" else {"keep": Original(io.BytesIO(SQUARE))}
    with pytest.raises(InvalidParameters, match=message):
        written(kind, read_mesh(io.BytesIO(SQUARE)), HALVES, **keep, **options)
