"""The archive of parts: each file is a segment, as it is or closed."""

import io
import struct

import numpy as np
import pytest
import trimesh
from hypothesis import given

from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.polygon_soups import read
from helpers.files.written import members, written
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.parts.writer import write_parts
from segcore.io.threemf.writer import write_3mf
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]


@given(segmentations())
def test_the_archive_of_parts_holds_every_face_once(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    labels = hierarchy.labels(segments)
    for part_format in ("stl", "obj"):
        files = members(written("zip", *segmented, part_format=part_format))
        offset = np.array(files.pop("offset.txt", b"0 0 0").split()[:3], dtype=np.float64)
        assert sorted(files) == [f"segment_{k}.{part_format}" for k in range(segments)]
        for k in range(segments):
            corners = read(files[f"segment_{k}.{part_format}"], part_format).corners
            np.testing.assert_array_equal(corners.astype("f4"), (mesh.corners[labels == k] - offset).astype("f4"))


@pytest.mark.parametrize("capped", [False, True])
def test_stl_parts_far_from_the_origin_keep_their_details(burr: tuple[Mesh, Hierarchy], capped: bool) -> None:
    mesh, hierarchy = burr
    place = np.array([500_000.0, 4_500_000.0, 100.0])
    far = Mesh(mesh.vertices + place, mesh.faces)
    near = members(written("zip", mesh, hierarchy, 7, capped=capped))
    files = members(written("zip", far, hierarchy, 7, capped=capped))
    assert list(files) == [*near, "offset.txt"]
    offset = np.array(files["offset.txt"].split()[:3], dtype=np.float64)
    np.testing.assert_allclose(offset, place, atol=np.ptp(mesh.vertices))
    size = np.ptp(mesh.vertices)
    for name, data in near.items():
        moved = read(files[name]).corners + offset - place
        assert np.ptp(moved.reshape(-1, 3), axis=0) == pytest.approx(
            np.ptp(read(data).vertices, axis=0), abs=1e-6 * size
        )
        if not capped:
            np.testing.assert_allclose(moved, read(data).corners, atol=1e-6 * size)
    assert "offset.txt" not in members(written("zip", far, hierarchy, 7, part_format="obj"))


def test_the_normals_of_stl_parts_are_those_of_the_faces() -> None:
    mesh, hierarchy = two_strips()
    data = members(written("zip", mesh, hierarchy, 1))["segment_0.stl"]
    part = trimesh.load(io.BytesIO(data), file_type="stl", process=False)
    assert struct.unpack_from("<3f", data, 84) == tuple(part.face_normals[0])


def test_parts_keep_their_order_in_a_list_of_files(burr: tuple[Mesh, Hierarchy]) -> None:
    files = list(members(written("zip", *burr, 12)))
    assert files == sorted(files)
    assert len(files) == 12


@pytest.mark.parametrize("kind", ["3mf", "zip"])
def test_capped_files_hold_the_closed_parts(burr: tuple[Mesh, Hierarchy], kind: str) -> None:
    target = io.BytesIO()
    (write_3mf if kind == "3mf" else write_parts)(target, *burr, 7, capped=True)
    if kind == "3mf":
        parts = list(trimesh.load(target, file_type="3mf").geometry.values())
    else:
        parts = [trimesh.load(io.BytesIO(data), file_type="stl") for data in members(target.getvalue()).values()]
    assert len(parts) == 7
    assert all(part.is_watertight for part in parts)


def test_stl_parts_that_stl_cannot_hold_are_refused() -> None:
    mesh, hierarchy = two_strips(0.0, 1e60)
    with pytest.raises(InvalidParameters, match="OBJ"):
        written("zip", mesh, hierarchy)
    with pytest.raises(InvalidParameters, match="stl or obj"):
        written("zip", mesh, hierarchy, part_format="dae")
    files = members(written("zip", mesh, hierarchy, 1, part_format="obj"))
    assert read(files["segment_0.obj"]).corners.tolist() == mesh.corners.tolist()
