"""What is measured on the surface of an asset, without its authored parts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from bench.assets.metrics import Reference, one_minus_rand
from bench.datasets import on_surface
from segcore.clean.edge_geometry import dihedral_angles, edge_lengths
from segcore.graphs.surface_graph import connected_components

if TYPE_CHECKING:
    from segcore.arrays import FloatArray, IntArray
    from segcore.clean.surface import Surface

_DIGITS = 6  # of a distance over the extent: images that agree in these are equally near
_COPLANAR = math.radians(1)  # largest angle between faces that count as coplanar; set by hand


def component_labels(surface: Surface) -> IntArray:
    """(F_input,) connected component 0, 1, ... of every input face, after welding."""
    components = connected_components(surface.edge_faces, len(surface.faces))
    labels: IntArray = components[surface.face_of_input]
    return labels


def flat_share(surface: Surface, label: IntArray) -> float:
    """Share of the length of a cut that runs between faces coplanar to within a degree; 0 if there is no cut.

    Parameters
    ----------
    label : (F_input,) segment of every input face.
    """
    of_face = on_surface(surface, label)
    cut = of_face[surface.edge_faces[:, 0]] != of_face[surface.edge_faces[:, 1]]
    length = np.where(cut, edge_lengths(surface), 0.0)
    total = float(length.sum())
    return float(length[np.abs(dihedral_angles(surface)) < _COPLANAR].sum()) / total if total > 0 else 0.0


def mirror_disagreement(centres: FloatArray, area: FloatArray, label: IntArray) -> float:
    """1 - Rand, by area, of a segmentation against its own mirror image; 0 for a symmetric one.

    The plane of the reflection is perpendicular to the x, y or z axis, in the middle of the bounding box of the
    centres: of the three the one in which the shape is most symmetric, the first of equal ones. The mirror image of a
    face has the label of the face with the nearest centre.

    Parameters
    ----------
    centres : (F, 3) centroids of the faces.
    """
    middle = (centres.min(axis=0) + centres.max(axis=0)) / 2
    tree = KDTree(centres)
    images = [tree.query(np.where(np.arange(3) == axis, 2 * middle - centres, centres)) for axis in range(3)]
    size = float(np.ptp(centres, axis=0).max() * area.sum()) or 1.0
    _, nearest = min(images, key=lambda image: round(float(np.dot(image[0], area)) / size, _DIGITS))
    return one_minus_rand(Reference(label[nearest].astype(np.int64), area).shared_areas(label))
