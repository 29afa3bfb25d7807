"""Contacts: where two closed parts touch, the plane of it, and the largest circle inside it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from segcore.arrays import FloatArray, IntArray, plane_axes
from segcore.graphs.surface_graph import connected_components
from segcore.printing.booleans import region
from segcore.printing.circles import Circle, largest_circle

_LEAST_WIDTH = 0.02  # of its length, that a border must have across it to define a plane; set by hand
_MOST_BORDERS = 64  # of two parts; set by hand: shells that touch all over have thousands of small ones
_ROUNDING = 1e-9  # of the extent of a border


@dataclass(frozen=True, slots=True, eq=False)
class Closed:
    """A closed part."""

    label: int
    vertices: FloatArray  # (V, 3)
    faces: IntArray  # (F, 3) the faces of the input, then the caps
    first_cap: int

    @property
    def caps(self) -> FloatArray:
        """(C, 3, 3) the corners of the caps."""
        corners: FloatArray = self.vertices[self.faces[self.first_cap :]]
        return corners


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """A place at which two parts touch."""

    parts: tuple[int, int]
    centre: FloatArray  # (3,) of the largest circle, else of the border
    normal: FloatArray | None  # (3,) unit normal from the first part to the second; None without a plane
    area: float  # of the common region of the caps in the plane
    radius: float  # of the largest circle in that region; 0 if there is none
    deviation: float  # the largest distance of a vertex of the border from the plane


def find_contacts(
    vertices: FloatArray, faces: IntArray, labels: IntArray, parts: Mapping[int, Closed]
) -> list[Contact]:
    """Return the contacts of all pairs of parts, ordered by the labels.

    The edges between two parts are divided into connected borders. A border defines the plane that fits it best, and
    the contact is the region that the caps of both parts cover in that plane. Two borders of one region, as the two
    rings where a pipe is cut, are one contact. Of two parts, the 64 borders with the most edges count.

    Parameters
    ----------
    vertices, faces, labels : the surface of which the parts are made, and the part of every face.
    """
    found: list[Contact] = []
    for pair, edges in _common_edges(faces, labels):
        if not parts.keys() >= set(pair):
            continue
        piece = _connected(edges)
        for number in np.argsort(-np.bincount(piece), kind="stable")[:_MOST_BORDERS].tolist():
            border = vertices[np.unique(edges[piece == number])]
            contact = _contact(parts[pair[0]], parts[pair[1]], border)
            if not any(_is_same(contact, other) for other in found):
                found.append(contact)
    return found


def _common_edges(faces: IntArray, labels: IntArray) -> Iterator[tuple[tuple[int, int], IntArray]]:
    """Yield each pair of labels with the edges (E, 2) between a face of one and a face of the other."""
    ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    label = np.repeat(labels, 3)
    order = np.lexsort((label, ends[:, 1], ends[:, 0]))
    ends, label = ends[order], label[order]
    joined = (ends[1:] == ends[:-1]).all(axis=1) & (label[1:] != label[:-1])
    pairs, edges = np.stack([label[:-1], label[1:]], axis=1)[joined], ends[1:][joined]
    distinct, which = np.unique(pairs, axis=0, return_inverse=True)
    for k, (one, other) in enumerate(distinct.tolist()):
        yield (one, other), edges[which.reshape(-1) == k]


def _connected(edges: IntArray) -> IntArray:
    """(E,) the number of the connected border that each edge belongs to."""
    used, numbers = np.unique(edges, return_inverse=True)
    numbered = numbers.reshape(-1, 2).astype(np.int32)
    piece: IntArray = connected_components(numbered, len(used))[numbered[:, 0]]
    return piece


def _contact(one: Closed, other: Closed, border: FloatArray) -> Contact:
    centre = border.mean(axis=0)
    _, extent, axes = np.linalg.svd(border - centre, full_matrices=False)
    pair = (one.label, other.label)
    if len(border) < 3 or extent[1] < _LEAST_WIDTH * extent[0]:
        return Contact(pair, centre, None, 0.0, 0.0, 0.0)
    deviation = float(np.abs((border - centre) @ axes[2]).max())
    reach = deviation + _ROUNDING * float(extent[0])
    caps = [_near(part.caps, centre, axes[2], reach) for part in (one, other)]
    normal = _outward(caps[0], axes[2])
    frame = plane_axes(normal)
    common = region((caps[0] - centre) @ frame.T) ^ region((caps[1] - centre) @ frame.T)
    outline = (border - centre) @ frame.T
    regions = [part for part in common.decompose() if _touches(part.to_polygons(), outline, reach)]
    best: tuple[float, Circle] | None = None
    for part in regions:
        circle = largest_circle(part)
        if circle is not None and (best is None or circle.radius > best[1].radius):
            best = part.area(), circle
    if best is None:
        return Contact(pair, centre, normal, 0.0, 0.0, deviation)
    return Contact(pair, centre + best[1].centre @ frame, normal, best[0], best[1].radius, deviation)


def _near(triangles: FloatArray, centre: FloatArray, normal: FloatArray, reach: float) -> FloatArray:
    """The triangles (N, 3, 3) of which no corner is farther from a plane than ``reach``."""
    near: FloatArray = triangles[(np.abs((triangles - centre) @ normal) <= reach).all(axis=1)]
    return near


def _outward(triangles: FloatArray, normal: FloatArray) -> FloatArray:
    """The normal or its opposite: that in the direction of the triangles."""
    area = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]).sum(axis=0)
    return -normal if area @ normal < 0 else normal


def _touches(polygons: list[FloatArray], points: FloatArray, reach: float) -> bool:
    """Whether a corner of the polygons is as near to one of the points as rounding and the reach allow."""
    if not polygons:
        return False
    gap = float(np.min(KDTree(points).query(np.concatenate(polygons))[0]))
    return gap <= reach + _ROUNDING * float(np.abs(points).max())


def _is_same(contact: Contact, other: Contact) -> bool:
    gap = float(np.linalg.norm(contact.centre - other.centre))
    return contact.parts == other.parts and gap < max(contact.radius, other.radius)
