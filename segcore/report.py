"""Report on a mesh: its size, its components and the defects that cleaning repairs."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.coordinates import Axis, Unit
from segcore.mesh import Mesh
from segcore.parameters import Structure

# The stages are imported in functions: the report of a stored result is read without them.
if TYPE_CHECKING:
    from segcore.clean.surface import Surface

_FOLLOWED: tuple[Structure, ...] = ("shells", "groups", "materials")


@dataclass(frozen=True, slots=True)
class StructureCounts:
    """The number of parts for every value of the parameter ``structure``; 0 if it cannot be used with this mesh."""

    shells: int
    groups: int
    materials: int

    def named(self) -> dict[Structure, int]:
        """The counts by the values of the parameter."""
        return {"shells": self.shells, "groups": self.groups, "materials": self.materials}

    @property
    def has_parts(self) -> bool:
        """Whether there is a structure of several parts."""
        return max(self.named().values()) > 1

    def in_words(self) -> str:
        """The counts that are not 0, such as ``96 shells, 1 group, 14 materials``."""
        return ", ".join(f"{count} {name if count > 1 else name[:-1]}" for name, count in self.named().items() if count)


@dataclass(frozen=True, slots=True)
class MeshReport:
    """Counts and measures of a mesh as it was read. None of the defects prevents a segmentation.

    Edges are counted after welding and before stitching, components after both, without degenerate and duplicate faces.
    """

    vertices: int
    faces: int
    polygons: int  # of the file, before triangulation
    welded_vertices: int  # replaced by another one at the same place
    unused_vertices: int  # used by no face
    degenerate_faces: int  # two of their corners are at the same place
    sliver_faces: int  # without a reliable normal: their corners are nearly collinear
    duplicate_faces: int  # with the same corners as an earlier face
    flipped_faces: int  # reversed, so that neighbours agree and closed parts face outward
    components: int  # sets of faces that are connected by edges
    border_edges: int  # with one face
    non_manifold_edges: int  # with three or more faces
    is_closed: bool  # no border edges and no non-manifold edges: the surface bounds a volume
    lower: tuple[float, float, float]  # corner of the bounding box, in units of the mesh
    upper: tuple[float, float, float]
    area: float  # in squared units of the mesh
    volume: float | None  # in cubed units of the mesh; None if the surface is not closed
    groups: tuple[str, ...]  # names of the groups of the file
    structure: StructureCounts | None = None  # None in reports of earlier versions
    stitched_edges: int = 0  # border edges that are joined to others across cracks and at T-junctions
    stitched_gap: float = 0.0  # widest gap between two of them, in units of the mesh: the tolerance that was found
    unit: Unit | None = None  # of the coordinates; None if it is not known
    up: Axis | None = None  # the axis that points up; None if it is not known
    shown_up: Axis = "y"  # the axis that points up in pictures
    notes: tuple[str, ...] = ()  # what the reader left out of the file or repaired, in sentences


def mesh_report(mesh: Mesh, surface: "Surface | None" = None) -> MeshReport:
    """Inspect a mesh.

    Parameters
    ----------
    surface : ``build_surface(mesh)``, if the caller has computed it already.
    """
    from segcore.clean.surface import build_surface, distinct_faces
    from segcore.clean.topology import dual_edges
    from segcore.clean.welding import weld

    surface = surface or build_surface(mesh)
    corners = weld(mesh.vertices, mesh.faces)[mesh.faces]
    a, b, c = corners.T
    proper = (a != b) & (b != c) & (c != a)
    faces = surface.faces if surface.stitched_edges == 0 else corners[distinct_faces(corners)[0]]
    dual = dual_edges(faces, len(mesh.vertices))
    non_manifold = len(np.unique(dual.vertices[~dual.is_manifold], axis=0))
    pairs, chained = int(dual.is_manifold.sum()), int((~dual.is_manifold).sum())
    border = 3 * len(faces) - 2 * pairs - chained - non_manifold  # m chained faces have m - 1 dual edges
    used = mesh.is_used
    representatives = np.zeros(len(mesh.vertices), dtype=bool)
    representatives[corners] = True
    is_closed = bool(proper.any()) and border == 0 and non_manifold == 0
    points = mesh.vertices[used]
    counts = structure_counts(mesh, surface)
    return MeshReport(
        vertices=len(mesh.vertices),
        faces=len(mesh.faces),
        polygons=_polygons(mesh),
        welded_vertices=int(used.sum() - representatives.sum()),
        unused_vertices=int((~used).sum()),
        degenerate_faces=int((~proper).sum()),
        sliver_faces=_slivers(surface) if proper.any() else 0,
        duplicate_faces=int(proper.sum()) - len(surface.faces) if proper.any() else 0,
        flipped_faces=int(surface.is_flipped.sum()) if proper.any() else 0,
        components=counts.shells,
        border_edges=border if proper.any() else 0,
        non_manifold_edges=non_manifold,
        is_closed=is_closed,
        lower=_triple(points.min(axis=0)),
        upper=_triple(points.max(axis=0)),
        area=float(surface.areas.sum()) * surface.unit**2,
        volume=_volume(surface) if is_closed else None,
        groups=mesh.appearance.group_names if mesh.appearance else (),
        structure=counts,
        stitched_edges=surface.stitched_edges,
        stitched_gap=surface.stitched_gap * surface.unit,
        unit=mesh.coordinates.unit,
        up=mesh.coordinates.up,
        shown_up=mesh.coordinates.shown_up,
        notes=mesh.notes,
    )


def structure_counts(mesh: Mesh, surface: "Surface") -> StructureCounts:
    """Count the parts that the first levels of a hierarchy would follow, by the values of ``structure``.

    Parameters
    ----------
    surface : ``build_surface(mesh)``.
    """
    from segcore.coarsen.authored import authored_parts

    shells, groups, materials = (authored_parts(surface, mesh, structure) for structure in _FOLLOWED)
    return StructureCounts(_count(shells), _count(groups), _count(materials))


def structure_note(counts: StructureCounts, structure: Structure, max_segments: int) -> str | None:
    """A sentence for people on how the structure limits a hierarchy; None if it does not.

    Parameters
    ----------
    structure, max_segments : the parameters of the segmentation.
    """
    from segcore.coarsen.authored import MOST_AUTHORED

    if structure == "none":
        return None
    parts = counts.named()[structure]
    if parts == 1:
        return f"The {structure} of the file are one part, so that structure={structure} has no effect."
    if parts > MOST_AUTHORED:
        return (
            f"The file has {parts} {structure}: the {MOST_AUTHORED} largest are segments of their own, and each of the "
            "others is in the segment of the nearest."
        )
    if parts >= max_segments:
        return (
            f"The hierarchy ends with the {parts} {structure} of the file: choose max_segments above {parts} to cut "
            "them further."
        )
    return None


def _count(part: IntArray | None) -> int:
    return 0 if part is None else int(part.max()) + 1


def _polygons(mesh: Mesh) -> int:
    return len(mesh.faces) if mesh.source_polygon is None else len(np.unique(mesh.source_polygon))


def _slivers(surface: "Surface") -> int:
    from segcore.clean.orientation import reliable_normals

    return int((~reliable_normals(surface.vertices, surface.faces)[0].any(axis=1)).sum())


def _volume(surface: "Surface") -> float:
    """The enclosed volume in cubed units of the mesh."""
    from segcore.clean.orientation import patch_volumes

    count = len(surface.faces)
    whole, unflipped = np.zeros(count, dtype=np.int32), np.zeros(count, dtype=bool)
    return float(patch_volumes(surface.vertices, surface.faces, whole, unflipped, 1)[1][0]) * surface.unit**3


def _triple(point: FloatArray) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return x, y, z
