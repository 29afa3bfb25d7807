"""The 3MF writer: the objects are the segments, as another program reads them."""

import io
import re

import numpy as np
import trimesh
from hypothesis import given

from helpers.files.hierarchies import segmentations
from helpers.files.written import members, written
from helpers.printing.solids import halves
from segcore import shapes
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh
from segcore.io.parts.pieces import closed_parts
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]


@given(segmentations())
def test_trimesh_reads_the_objects_of_3mf_in_place(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    proper = [len({*face}) == 3 for face in mesh.faces.tolist()]
    labels = np.where(proper, hierarchy.labels(segments), -1)
    if labels.max() < 0:
        return
    scene = trimesh.load(io.BytesIO(written("3mf", *segmented, capped=False)), file_type="3mf", process=False)
    found = {name: [] for name in scene.geometry}
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        assert (transform[:3, :3] == np.eye(3)).all()
        found[name] = (scene.geometry[name].triangles + transform[:3, 3]).tolist()
    expected = {f"segment {k}": mesh.corners[labels == k].tolist() for k in range(segments) if (labels == k).any()}
    assert found == expected


def test_objects_are_closed_unless_they_are_to_be_open(burr: tuple[Mesh, Hierarchy]) -> None:
    for capped in (None, True, False):
        scene = trimesh.load(io.BytesIO(written("3mf", *burr, 7, capped=capped)), file_type="3mf")
        assert [part.is_watertight for part in scene.geometry.values()] == [capped is not False] * 7


def test_a_mesh_far_from_the_origin_keeps_its_details_in_programs_that_use_float32() -> None:
    ball = shapes.icosphere(2)
    mesh = Mesh(ball.vertices + np.array([500_000.0, 4_500_000.0, 0.1]), ball.faces)
    hierarchy = halves(mesh, np.arange(len(mesh.faces)) < 100)
    for capped in (True, False):
        data = written("3mf", mesh, hierarchy, 1, capped=capped)
        back = read_mesh(io.BytesIO(data))
        assert sorted(map(tuple, back.vertices.tolist())) == sorted(map(tuple, mesh.vertices.tolist()))
        model = members(data)["3D/3dmodel.model"].decode()
        places = re.findall(r'<vertex x="(\S+)" y="(\S+)" z="(\S+)"/>', model)
        assert np.abs(np.array(places, dtype=np.float64)).max() < 3


def test_an_object_that_is_no_solid_says_so() -> None:
    strip = Mesh(
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0.0]]), [[0, 1, 2], [0, 1, 3], [0, 1, 4]]
    )
    hierarchy = halves(strip, np.array([True, True, False]))
    (part,) = closed_parts(strip, hierarchy, 1)
    model = members(written("3mf", strip, hierarchy, 1))["3D/3dmodel.model"].decode()
    assert ("not a solid" in model) == (part.is_solid is False)
