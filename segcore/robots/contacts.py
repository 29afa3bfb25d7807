"""Contacts of parts: the tree of joints along them, and whether a contact can turn."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import minimum_spanning_tree

from segcore.array_kernels import distinct_pairs
from segcore.arrays import FloatArray, IntArray
from segcore.clean.surface import Surface
from segcore.graphs.surface_graph import connected_components
from segcore.part_list.neighbours import BorderPlane, neighbours_of_parts

_NEARER = 1e-3  # weight of the distance of centres beside that of boxes, which may all be 0
# Of a border that turns, its deviation from the plane over the radius of a circle of its length; set by hand.
_LARGEST_DEVIATION = 0.2

Pair = tuple[int, int]  # of parts, the lower number first


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """The common border of two parts; lengths in metres."""

    length: float
    plane: BorderPlane | None  # its normal to the side of the part with the higher number
    loops: int  # connected pieces of the border


def find_contacts(surface: Surface, vertices: FloatArray, labels: IntArray, centres: FloatArray) -> dict[Pair, Contact]:
    """Return the contacts of parts by their numbers.

    Parameters
    ----------
    vertices : (V, 3) the positions of the vertices of the surface.
    labels : (F,) the part of every face of the surface.
    centres : (K, 3) of the parts.
    """
    loops = _loops(surface, labels)
    return {
        (part, other.part): Contact(other.length, other.plane, loops[part, other.part])
        for part, others in enumerate(neighbours_of_parts(surface, vertices, labels, centres))
        for other in others
        if part < other.part
    }


def _loops(surface: Surface, labels: IntArray) -> dict[Pair, int]:
    """The number of connected pieces of each border."""
    sides = np.sort(labels[surface.edge_faces], axis=1)
    at = np.flatnonzero(sides[:, 0] != sides[:, 1])
    if len(at) == 0:
        return {}
    pairs, of_pair = distinct_pairs(sides[at])
    ends = surface.edge_vertices[at].astype(np.int64) + of_pair[:, None] * len(surface.vertices)
    known, numbers = np.unique(ends, return_inverse=True)
    piece = connected_components(numbers.reshape(-1, 2).astype(np.int32), len(known))
    _, first = np.unique(piece, return_index=True)
    count = np.bincount(known[first] // len(surface.vertices), minlength=len(pairs))
    return {(a, b): loops for (a, b), loops in zip(pairs.tolist(), count.tolist(), strict=True)}


def joint_tree(contacts: Mapping[Pair, Contact], boxes: FloatArray) -> csr_array:
    """(K, K) a spanning tree of the parts, in the longest contacts that there are.

    Parts without a contact to the others are joined to the part whose box is nearest.

    Parameters
    ----------
    boxes : (K, 2, 3) the lowest and the highest corners of the parts.
    """
    low, high = boxes[:, 0], boxes[:, 1]
    gaps = np.maximum(low[:, None] - high[None], low[None] - high[:, None]).clip(min=0.0)
    middles = boxes.mean(axis=1)
    apart = np.linalg.norm(middles[:, None] - middles[None], axis=2)
    weight = np.linalg.norm(gaps, axis=2) + _NEARER * apart + np.finfo(np.float64).tiny
    for (one, other), contact in contacts.items():
        weight[one, other] = weight[other, one] = -contact.length
    np.fill_diagonal(weight, 0.0)
    return csr_array(minimum_spanning_tree(weight))


def why_fixed(pair: Pair, contacts: Mapping[Pair, Contact], count: int) -> str | None:
    """Return why a joint between two parts cannot be a hinge; None if it can.

    Parameters
    ----------
    count : K, the number of parts.
    """
    contact = contacts.get(pair)
    if contact is None:
        return "the parts have no common border"
    if contact.loops > 1:
        return f"the parts touch at {contact.loops} places"
    if contact.plane is None:
        return "the border is straight, so that it has no plane"
    if contact.plane.largest_deviation > _LARGEST_DEVIATION * contact.length / (2 * np.pi):
        return "the border is not plane"
    others = np.array([other for other in contacts if other != pair], dtype=np.int32).reshape(-1, 2)
    component = connected_components(others, count)
    if component[pair[0]] == component[pair[1]]:
        return "other contacts join the parts as well"
    return None
