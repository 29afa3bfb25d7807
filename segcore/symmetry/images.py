"""The mirror image of every face of a symmetric surface."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.surface import Surface
from segcore.mesh import face_centroids
from segcore.symmetry.reflection import Reflection, find_reflection

# All set by hand.
_NORMAL = 0.1  # distance, in sqrt(total area), that counts as much as a difference of normals of 1
_EXACT = 0.1  # distance of an image from its face, in sqrt(area of the face), up to which the meshes coincide
_MESHED_ALIKE = 0.9  # share of the area with exact images from which the mesh is symmetric and not only the shape


@dataclass(frozen=True, slots=True, eq=False)
class MirrorImage:
    """The two halves of a symmetric surface, and the image of every face in the other half."""

    reflection: Reflection
    is_first: BoolArray  # (F,) True for the faces of the first half, on the side of the normal
    of_face: IntArray  # (F,) the nearest face of the other half to the image of every face
    meshed_alike: bool  # the faces of the halves are images of each other, apart from a few


def mirror_image(surface: Surface) -> MirrorImage | None:
    """The mirror image of a surface, or None if the surface is not symmetric."""
    reflection = find_reflection(surface)
    return None if reflection is None else image_under(surface, reflection)


def image_under(surface: Surface, reflection: Reflection) -> MirrorImage | None:
    """The mirror image of a surface under a reflection that maps it to itself; None if one half has no face.

    A face whose centroid is in the plane is in the first half. The image of a face is the face of the other half that
    is nearest to its mirrored centroid, with the distance of the normals as a further coordinate.
    """
    centres = face_centroids(surface.vertices, surface.faces)
    is_first = reflection.heights(centres) >= 0.0
    if is_first.all() or not is_first.any():
        return None
    size = float(np.sqrt(surface.areas.sum()))
    places = np.concatenate([centres, _NORMAL * size * surface.normals], axis=1)
    images = np.concatenate(
        [reflection.of_points(centres), _NORMAL * size * reflection.of_directions(surface.normals)], axis=1
    )
    of_face = np.empty(len(centres), dtype=np.int32)
    for here in (is_first, ~is_first):
        there = np.flatnonzero(~here)
        of_face[here] = there[KDTree(places[there]).query(images[here])[1]]
    away = np.linalg.norm(centres[of_face] - reflection.of_points(centres), axis=1)
    exact = away <= _EXACT * np.sqrt(surface.areas)
    return MirrorImage(reflection, is_first, of_face, bool(_share(surface.areas, exact) >= _MESHED_ALIKE))


def _share(areas: FloatArray, chosen: BoolArray) -> float:
    return float(areas[chosen].sum() / areas.sum())
