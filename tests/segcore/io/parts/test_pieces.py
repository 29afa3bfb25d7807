"""Segments as separate meshes: closed ones have no border."""

import pytest
import trimesh
from hypothesis import given

from helpers.files.hierarchies import segmentations
from segcore.hierarchy import Hierarchy
from segcore.io.parts.pieces import closed_parts
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]


@pytest.mark.parametrize("segments", [1, 2, 7, 20, 64])
def test_capped_parts_are_closed_and_consistent(burr: tuple[Mesh, Hierarchy], segments: int) -> None:
    mesh, hierarchy = burr
    volume = 0.0
    for part in closed_parts(mesh, hierarchy, segments):
        solid = trimesh.Trimesh(part.vertices, part.faces, process=False)
        assert solid.is_watertight
        assert solid.is_winding_consistent
        volume += float(solid.volume)
    whole = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume
    if segments <= 7:  # the arms are cut off along nearly plane loops, so that the two caps of a cut nearly coincide
        assert volume == pytest.approx(whole, rel=1e-2)


@given(segmentations())
def test_the_border_of_a_capped_part_of_any_mesh_is_empty(segmented: Segmented) -> None:
    mesh, hierarchy, segments = segmented
    for part in closed_parts(mesh, hierarchy, segments):
        flow: dict[tuple[int, int], int] = {}
        for face in part.faces.tolist():
            for a, b in zip(face, face[1:] + face[:1], strict=True):
                flow[min(a, b), max(a, b)] = flow.get((min(a, b), max(a, b)), 0) + (1 if a < b else -1)
        assert not any(count for (a, b), count in flow.items() if a != b)
