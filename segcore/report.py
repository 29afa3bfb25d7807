"""What is found in a mesh: how it hangs together, and what had to be put right before it could be cut."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import BoolArray, FloatArray
from segcore.clean.surface import Surface, build_surface
from segcore.clean.topology import dual_edges
from segcore.clean.welding import weld
from segcore.graphs.surface_graph import connected_components
from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True)
class MeshReport:
    """Counts of a mesh as it was sent; nothing of it keeps a mesh from being segmented.

    Edges and components are those after welding, without degenerate and duplicate faces.
    """

    vertices: int
    faces: int
    polygons: int  # of the file, before they were cut into triangles
    welded_vertices: int  # taken for another one at the same place
    unused_vertices: int  # that no face has
    degenerate_faces: int  # with two corners at the same place
    sliver_faces: int  # without a reliable direction, as their corners are nearly on a line
    duplicate_faces: int  # with the corners of an earlier face
    flipped_faces: int  # turned round, so that neighbours agree and closed parts face outward
    components: int  # sets of faces joined by edges
    border_edges: int  # with one face
    non_manifold_edges: int  # with three faces or more
    is_closed: bool  # no border edges and no non-manifold ones: the surface bounds a volume
    lower: tuple[float, float, float]  # corner of the bounding box, in units of the mesh
    upper: tuple[float, float, float]
    area: float  # in squared units of the mesh
    volume: float | None  # in cubed units of the mesh; None where the surface is not closed
    groups: tuple[str, ...]  # names in the file


def mesh_report(mesh: Mesh, surface: Surface | None = None) -> MeshReport:
    """Inspect a mesh.

    Parameters
    ----------
    surface : ``build_surface(mesh)``, where the caller has it already.
    """
    surface = surface or build_surface(mesh)
    corners = weld(mesh.vertices, mesh.faces)[mesh.faces]
    a, b, c = corners.T
    proper = (a != b) & (b != c) & (c != a)
    _, edge_vertices, manifold, _ = dual_edges(surface.faces, len(surface.vertices))
    non_manifold = len(np.unique(edge_vertices[~manifold], axis=0))
    border = 3 * len(surface.faces) - 2 * int(manifold.sum()) - int((~manifold).sum()) - non_manifold
    used = np.zeros(len(mesh.vertices), dtype=bool)
    used[mesh.faces] = True
    standing = np.zeros(len(mesh.vertices), dtype=bool)
    standing[corners] = True
    is_closed = bool(proper.any()) and border == 0 and non_manifold == 0
    points = mesh.vertices[used]
    return MeshReport(
        vertices=len(mesh.vertices),
        faces=len(mesh.faces),
        polygons=_polygons(mesh),
        welded_vertices=int(used.sum() - standing.sum()),
        unused_vertices=int((~used).sum()),
        degenerate_faces=int((~proper).sum()),
        sliver_faces=_slivers(surface) if proper.any() else 0,
        duplicate_faces=int(proper.sum()) - len(surface.faces) if proper.any() else 0,
        flipped_faces=_flipped(corners[proper], surface, proper) if proper.any() else 0,
        components=int(connected_components(surface.edge_faces, len(surface.faces)).max()) + 1,
        border_edges=border if proper.any() else 0,
        non_manifold_edges=non_manifold,
        is_closed=is_closed,
        lower=_triple(points.min(axis=0)),
        upper=_triple(points.max(axis=0)),
        area=float(surface.areas.sum()) * surface.unit**2,
        volume=_volume(surface) if is_closed else None,
        groups=mesh.appearance.group_names if mesh.appearance else (),
    )


def _polygons(mesh: Mesh) -> int:
    return len(mesh.faces) if mesh.source_polygon is None else len(np.unique(mesh.source_polygon))


def _slivers(surface: Surface) -> int:
    return int((~surface.normals.any(axis=1)).sum())


def _flipped(corners: FloatArray, surface: Surface, proper: BoolArray) -> int:
    """Faces that run through their corners the other way round in the surface."""
    stands_for = surface.face_of_input[proper]
    _, first = np.unique(stands_for, return_index=True)
    before, after = corners[first], surface.faces
    # Welded corners are numbered anew in the surface, but in the same order.
    return int(((before[:, 1] < before[:, 2]) != (after[:, 1] < after[:, 2])).sum())


def _volume(surface: Surface) -> float:
    """Enclosed volume, from the divergence theorem."""
    p, q, r = surface.vertices[surface.faces].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", p, np.cross(q, r)) / 6) * surface.unit**3


def _triple(point: FloatArray) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return x, y, z
