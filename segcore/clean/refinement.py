"""Division of the faces that are large beside their component, for the computation alone."""

from dataclasses import dataclass, replace

import numpy as np

from segcore.array_kernels import distinct_pairs
from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.clean.orientation import reliable_normals
from segcore.clean.stitching import stitch
from segcore.clean.surface import Surface
from segcore.clean.topology import dual_edges
from segcore.graphs.surface_graph import connected_components
from segcore.jit.decorators import inner_kernel, kernel
from segcore.threads import in_blocks

# Longest edges that are not divided, set by hand.
_OF_COMPONENT = 0.06  # in the square root of the area of the component
_OF_WHOLE = 0.03  # in the square root of the total area
# Share of the area of a component in faces with longer edges, below which it is left as it is. Set by hand: it is 0.08
# at most on the benchmark, whose meshes are fine, and 0.3 at least on CAD files.
_LEAST_SHARE = 0.15
_MOST_ADDED = 20_000  # faces; a limit of time
_MOST_PASSES = 30  # a surface with a longer edge than 2**30 of those allowed has no reliable area


@dataclass(frozen=True, slots=True, eq=False)
class Refinement:
    """A surface with its large faces divided, and the face that every piece is part of."""

    surface: Surface  # of N faces; the given surface itself if nothing was divided
    parent: IntArray  # (N,) ascending

    @property
    def is_piece(self) -> BoolArray:
        """(N,) True for the pieces of divided faces, False for faces that were left whole."""
        pieces: BoolArray = np.bincount(self.parent)[self.parent] > 1
        return pieces


def undivided(surface: Surface) -> Refinement:
    """A surface of whole faces."""
    return Refinement(surface, np.arange(len(surface.faces), dtype=np.int32))


def refine(surface: Surface) -> Refinement:
    """Divide the faces whose edges are long beside their component.

    Edges longer than both 0.06 sqrt(area of the component) and 0.03 sqrt(total area) are long. Components of which more
    than 15 % of the area are faces with long edges are divided: long edges are halved, the longest first, until there
    are none or until more than 20,000 faces would be added. Faces are cut between the midpoints of their edges: pieces
    tile their face, and neighbours share whole edges.
    """
    vertices, faces = surface.vertices, surface.faces
    parent = undivided(surface).parent
    allowed = _allowed_lengths(surface)
    if np.isinf(allowed).all():
        return undivided(surface)
    excess = _longest_edge(vertices, faces, allowed)
    if not 1.0 < excess < 2.0**_MOST_PASSES:
        return undivided(surface)
    most = len(faces) + _MOST_ADDED
    for doublings in reversed(range(int(np.ceil(np.log2(excess))))):
        is_long = _long_edges(vertices, faces, allowed[parent] * 2.0**doublings)
        if len(faces) + np.count_nonzero(is_long) > most:
            break
        middle, vertices = _with_midpoints(vertices, faces, is_long)
        faces, origin = _divided(vertices, faces, middle)
        parent = parent[origin]
    if len(faces) == len(surface.faces):
        return undivided(surface)
    return Refinement(_surface_of_pieces(surface, vertices, faces, parent), parent)


def _allowed_lengths(surface: Surface) -> FloatArray:
    """(F,) the longest edge that every face may have; infinity for components that are not divided."""
    total = float(surface.areas.sum())
    component = connected_components(surface.edge_faces, len(surface.faces))
    area = group_sums(component, surface.areas)
    allowed = np.maximum(_OF_COMPONENT * np.sqrt(area), _OF_WHOLE * np.sqrt(total))
    is_large = np.empty(len(component), dtype=bool)
    in_blocks(_find_long_edges, len(component), surface.vertices, surface.faces, allowed, component, is_large)
    in_large_faces = group_sums(component[is_large], surface.areas[is_large], len(area))
    of_face: FloatArray = np.where(in_large_faces > _LEAST_SHARE * area, allowed, np.inf)[component]
    return of_face


def _with_midpoints(vertices: FloatArray, faces: IntArray, is_long: BoolArray) -> tuple[IntArray, FloatArray]:
    """(F, 3) the midpoint of the edge from every corner to the next, -1 if it is not long, and all vertices."""
    face, corner = np.nonzero(is_long)
    ends, which = distinct_pairs(np.stack([faces[face, corner], faces[face, (corner + 1) % 3]], axis=1))
    middle = np.full(faces.shape, -1, dtype=np.int32)
    middle[face, corner] = len(vertices) + which
    points = 0.5 * (vertices[ends[:, 0]] + vertices[ends[:, 1]])
    return middle, np.concatenate([vertices, points])


def _surface_of_pieces(surface: Surface, vertices: FloatArray, faces: IntArray, parent: IntArray) -> Surface:
    """The surface of the pieces, which keep the normals of their faces."""
    dual = dual_edges(faces, len(vertices))
    if surface.stitched_edges:
        joined = stitch(vertices, faces, dual)
        vertices, faces, dual = joined.vertices, joined.faces, joined.dual
    authored = None if surface.authored is None else surface.authored[parent]
    inside = slice(None) if authored is None else authored[dual.faces[:, 0]] == authored[dual.faces[:, 1]]
    _, areas = reliable_normals(vertices, faces)
    first = np.searchsorted(parent, np.arange(len(surface.faces))).astype(np.int32)
    return replace(
        surface,
        vertices=vertices,
        faces=faces,
        normals=surface.normals[parent],
        areas=areas,
        edge_faces=dual.faces[inside],
        edge_vertices=dual.vertices[inside],
        face_of_input=first[surface.face_of_input],
        is_flipped=surface.is_flipped[parent],
        authored=authored,
    )


@inner_kernel
def _length(vertices, p, q):  # type: ignore[no-untyped-def]
    squared = 0.0
    for axis in range(3):
        squared += (vertices[p, axis] - vertices[q, axis]) ** 2
    return np.sqrt(squared)


@kernel
def _longest_edge(vertices: FloatArray, faces: IntArray, allowed: FloatArray) -> float:
    """The largest ratio of an edge to the length allowed to its face."""
    longest = 0.0
    for f in range(len(faces)):
        for k in range(3):
            longest = max(longest, _length(vertices, faces[f, k], faces[f, (k + 1) % 3]) / allowed[f])
    return longest


@kernel
def _find_long_edges(start, end, vertices, faces, allowed, component, found):  # type: ignore[no-untyped-def]
    """Write whether one of the edges of a face is longer than its component (C,) allows."""
    for f in range(start, end):
        found[f] = False
        for k in range(3):
            found[f] |= _length(vertices, faces[f, k], faces[f, (k + 1) % 3]) > allowed[component[f]]


@kernel
def _long_edges(vertices: FloatArray, faces: IntArray, allowed: FloatArray) -> BoolArray:
    """(F, 3) True if the edge from a corner to the next is longer than its face is allowed."""
    is_long = np.empty(faces.shape, np.bool_)
    for f in range(len(faces)):
        for k in range(3):
            is_long[f, k] = _length(vertices, faces[f, k], faces[f, (k + 1) % 3]) > allowed[f]
    return is_long


@kernel
def _divided(vertices: FloatArray, faces: IntArray, middle: IntArray) -> tuple[IntArray, IntArray]:
    """The faces cut between the midpoints of their edges (M, 3), and (M,) the face that each is part of.

    Parameters
    ----------
    middle : (F, 3) the midpoint of the edge from every corner to the next, -1 for edges that stay whole.
    """
    count = len(faces)
    for f in range(len(faces)):
        for k in range(3):
            count += middle[f, k] >= 0
    pieces = np.empty((count, 3), np.int32)
    origin = np.empty(count, np.int32)
    n = 0
    for f in range(len(faces)):
        start = n
        halved = (middle[f, 0] >= 0) + (middle[f, 1] >= 0) + (middle[f, 2] >= 0)
        k = 0  # the first corner: one or two halved edges then are a-b, or b-c and c-a
        if halved == 1:
            while middle[f, k] < 0:
                k += 1
        elif halved == 2:
            while middle[f, k] >= 0:
                k += 1
        a, b, c = faces[f, k], faces[f, (k + 1) % 3], faces[f, (k + 2) % 3]
        ab, bc, ca = middle[f, k], middle[f, (k + 1) % 3], middle[f, (k + 2) % 3]
        if halved == 0:
            n = _put(pieces, n, faces[f, 0], faces[f, 1], faces[f, 2])
        elif halved == 1:
            n = _put(pieces, n, a, ab, c)
            n = _put(pieces, n, ab, b, c)
        elif halved == 2:
            n = _put(pieces, n, ca, bc, c)
            if _length(vertices, a, bc) <= _length(vertices, b, ca):
                n = _put(pieces, n, a, b, bc)
                n = _put(pieces, n, a, bc, ca)
            else:
                n = _put(pieces, n, a, b, ca)
                n = _put(pieces, n, b, bc, ca)
        else:
            n = _put(pieces, n, a, ab, ca)
            n = _put(pieces, n, ab, b, bc)
            n = _put(pieces, n, ca, bc, c)
            n = _put(pieces, n, ab, bc, ca)
        for piece in range(start, n):
            origin[piece] = f
    return pieces, origin


@inner_kernel
def _put(pieces, n, a, b, c):  # type: ignore[no-untyped-def]
    pieces[n, 0], pieces[n, 1], pieces[n, 2] = a, b, c
    return n + 1
