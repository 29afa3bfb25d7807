"""The 3MF writer: the objects are the segments, as another program reads them."""

import io

import numpy as np
import trimesh
from hypothesis import given

from helpers.files.hierarchies import segmentations
from helpers.files.written import written
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]


@given(segmentations())
def test_trimesh_reads_the_objects_of_3mf_in_place(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    proper = [len({*face}) == 3 for face in mesh.faces.tolist()]
    labels = np.where(proper, hierarchy.labels(segments), -1)
    if labels.max() < 0:
        return
    scene = trimesh.load(io.BytesIO(written("3mf", *segmented)), file_type="3mf", process=False)
    found = {name: [] for name in scene.geometry}
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        assert (transform == np.eye(4)).all()
        found[name] = scene.geometry[name].triangles.tolist()
    expected = {f"segment {k}": mesh.corners[labels == k].tolist() for k in range(segments) if (labels == k).any()}
    assert found == expected
