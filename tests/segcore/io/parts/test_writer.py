"""The archive of parts: each file is a segment, as it is or closed."""

import io
import json
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
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]


@given(segmentations())
def test_the_archive_of_parts_holds_every_face_once(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    labels = hierarchy.labels(segments)
    for part_format in ("stl", "obj"):
        files = members(written("zip", *segmented, part_format=part_format, capped=False))
        listed = json.loads(files.pop("parts.json"))
        assert list(files) == sorted(f"segment_{k}.{part_format}" for k in range(segments))
        assert listed["parts"] == [
            {
                "file": f"segment_{k}.{part_format}",
                "label": k,
                "name": f"segment {k}",
                "faces": int((labels == k).sum()),
                "closed": None,
            }
            for k in range(segments)
        ]
        for k in range(segments):
            corners = read(files[f"segment_{k}.{part_format}"], part_format).corners
            expected = mesh.corners[labels == k] - listed["offset"]
            np.testing.assert_array_equal(corners.astype("f4"), expected.astype("f4"))


def test_parts_are_closed_by_default_if_they_are_for_printing(burr: tuple[Mesh, Hierarchy]) -> None:
    for options, expected in (({}, True), ({"capped": False}, None), ({"part_format": "obj"}, None)):
        files = members(written("zip", *burr, 7, names={2: "arm: left"}, **options))
        listed = json.loads(files["parts.json"])
        assert listed["offset"] == [0, 0, 0]
        assert [part["closed"] for part in listed["parts"]] == [expected] * 7
        assert [part["file"] for part in listed["parts"]] == list(files)[:-1]
        assert listed["parts"][2]["name"] == "arm: left"
        for part in listed["parts"]:
            solid = trimesh.load(io.BytesIO(files[part["file"]]), file_type=part["file"][-3:])
            assert len(solid.faces) == part["faces"]
            assert solid.is_watertight == bool(expected)


@pytest.mark.parametrize("capped", [False, True])
def test_stl_parts_far_from_the_origin_keep_their_details(burr: tuple[Mesh, Hierarchy], capped: bool) -> None:
    mesh, hierarchy = burr
    place = np.array([500_000.0, 4_500_000.0, 100.0])
    far = Mesh(mesh.vertices + place, mesh.faces)
    near = members(written("zip", mesh, hierarchy, 7, capped=capped))
    files = members(written("zip", far, hierarchy, 7, capped=capped))
    assert list(files) == list(near)
    offset = np.array(json.loads(files["parts.json"])["offset"])
    np.testing.assert_allclose(offset, place * [1, 1, 0], atol=np.ptp(mesh.vertices))
    assert offset[2] == 0  # it is not far out along this axis
    size = np.ptp(mesh.vertices)
    for name in list(near)[:-1]:
        moved, here = read(files[name]).corners + (offset - place), read(near[name])
        extent = np.ptp(moved.reshape(-1, 3), axis=0)
        assert extent == pytest.approx(np.ptp(here.vertices, axis=0), abs=1e-5 * size)
        if not capped:
            np.testing.assert_allclose(moved, here.corners, atol=1e-5 * size)
    assert json.loads(members(written("zip", far, hierarchy, 7, part_format="obj"))["parts.json"])["offset"] == [
        0,
        0,
        0,
    ]


def test_the_normals_of_stl_parts_are_those_of_the_faces() -> None:
    mesh, hierarchy = two_strips()
    data = members(written("zip", mesh, hierarchy, 1, capped=False))["segment_0.stl"]
    part = trimesh.load(io.BytesIO(data), file_type="stl", process=False)
    assert struct.unpack_from("<3f", data, 84) == tuple(part.face_normals[0])


def test_parts_keep_their_order_in_a_list_of_files(burr: tuple[Mesh, Hierarchy]) -> None:
    *files, last = members(written("zip", *burr, 12))
    assert files == sorted(files)
    assert len(files) == 12
    assert last == "parts.json"


def test_stl_parts_that_stl_cannot_hold_are_refused() -> None:
    mesh, hierarchy = two_strips(0.0, 1e60)
    with pytest.raises(InvalidParameters, match="OBJ"):
        written("zip", mesh, hierarchy)
    with pytest.raises(InvalidParameters, match="stl or obj"):
        written("zip", mesh, hierarchy, part_format="dae")
    files = members(written("zip", mesh, hierarchy, 1, part_format="obj"))
    assert read(files["segment_0.obj"]).corners.tolist() == mesh.corners.tolist()
