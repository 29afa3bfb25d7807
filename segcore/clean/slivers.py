"""Directions of faces without a reliable normal, which CAD programs leave where an edge ends inside another one."""

import numpy as np

from segcore.array_kernels import ascending
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.topology import DualEdges
from segcore.jit.decorators import inner_kernel, kernel


def with_borrowed_normals(normals: FloatArray, dual: DualEdges, vertices: FloatArray) -> FloatArray:
    """(F, 3) normals in which every sliver has that of a face that it continues.

    Slivers are joined across their edges, the longest first, until a group has a face with a normal. A sliver that
    fills the gap at a T-junction therefore continues the face at the whole edge, and the surface bends at the two parts
    of this edge, as it would without the sliver. Slivers that are not connected to other faces keep 0.

    Parameters
    ----------
    normals : (F, 3), 0 for slivers.
    dual : the dual edges of the faces.
    vertices : (V, 3)
    """
    is_sliver = np.logical_not(normals.any(axis=1))
    if not is_sliver.any():
        return normals
    at_sliver = np.flatnonzero(is_sliver[dual.faces].any(axis=1))
    ends = vertices[dual.vertices[at_sliver]]
    longest_first = at_sliver[ascending(-np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1))]
    source = _sources(dual.faces[longest_first], ~is_sliver)
    borrowed: FloatArray = normals[source]
    return borrowed


@kernel
def _sources(edges: IntArray, has_normal: BoolArray) -> IntArray:
    """(F,) the face whose normal every face takes: of a group of faces that edges (N, 2) join, the one that has one.

    Parameters
    ----------
    edges : in the order in which they join. Groups that have a normal each are not joined.
    has_normal : (F,)
    """
    parent = np.arange(len(has_normal)).astype(np.int32)
    for e in range(len(edges)):
        a, b = _root(parent, edges[e, 0]), _root(parent, edges[e, 1])
        if a != b and not (has_normal[a] and has_normal[b]):
            if has_normal[b]:
                a, b = b, a
            parent[b] = a
    for f in range(len(parent)):
        parent[f] = _root(parent, f)
    return parent


@inner_kernel
def _root(parent, f):  # type: ignore[no-untyped-def]
    while parent[f] != f:
        parent[f] = parent[parent[f]]
        f = parent[f]
    return f
