"""The mirror image of every face of a symmetric surface."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from segcore.array_kernels import face_centroids
from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums, largest_options
from segcore.clean.surface import Surface
from segcore.coarsen.assembly import NEGLIGIBLE
from segcore.graphs.surface_graph import connected_components
from segcore.symmetry.close_images import Halves, close_images, coinciding_area
from segcore.symmetry.reflection import Reflection, find_reflection
from segcore.threads import sums_of_blocks

# All set by hand.
_NORMAL = 0.1  # distance, in sqrt(total area), that counts as much as a difference of normals of 1
_IN_PLANE = 1e-9  # distance from the plane, in extents of the surface, that is rounding error
_VANISHING = 1e-12  # share of the area of a component in which halves cannot be told apart
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
    """The mirror image of a surface under a reflection that maps it to itself.

    A face whose centroid is in the plane is in the first half. The image of a face is the face of the other half that
    is nearest to its mirrored centroid, with the distance of the normals as a further coordinate. The images of the
    faces of one component are in one component.

    Returns
    -------
    None if one half has no face, if a component is nearly a point, or if a component that is not negligible has no
    component as its image.
    """
    centres = face_centroids(surface.vertices, surface.faces)
    is_first = reflection.heights(centres) >= -_IN_PLANE
    if is_first.all() or not is_first.any():
        return None
    far = _NORMAL * float(np.sqrt(surface.areas.sum()))
    plane = np.append(reflection.normal, reflection.offset)
    halves = Halves(centres, surface.normals, surface.areas, is_first, far, plane)
    component = connected_components(surface.edge_faces, len(surface.faces))
    faces = np.arange(len(centres), dtype=np.int32)
    of_face = np.empty(len(faces), dtype=np.int32)
    for here, there in ((faces[is_first], faces[~is_first]), (faces[~is_first], faces[is_first])):
        of_face[here] = close_images(halves, here, there)
    others = np.flatnonzero(of_face < 0).astype(np.int32)
    of_face[others] = _nearest(halves, reflection, others, faces)
    if component.max() > 0:
        area = group_sums(component, surface.areas)
        if area.min() < _VANISHING * area.sum():
            return None
        partner = _partners(component, component[of_face], surface.areas)
        if partner is None:
            return None
        for c in np.unique(component[partner[component] != component[of_face]]).tolist():
            here, there = faces[component == c], faces[component == partner[c]]
            of_face[here] = _nearest(halves, reflection, here, there, of_face[here])
    alike, whole = sums_of_blocks(coinciding_area, len(faces), halves, of_face)
    return MirrorImage(reflection, is_first, of_face, bool(alike >= _MESHED_ALIKE * whole))


def _nearest(
    halves: Halves, reflection: Reflection, faces: IntArray, among: IntArray, otherwise: IntArray | None = None
) -> IntArray:
    """(M,) the nearest of some faces to the image of every face (M,), in the other half.

    Parameters
    ----------
    otherwise : (M,) the result if none of the faces to choose from is in the other half.
    """
    result = np.zeros(len(faces), dtype=np.int32) if otherwise is None else otherwise.copy()
    for half in (True, False):
        here = halves.is_first[faces] == half
        there = among[halves.is_first[among] != half]
        asked = faces[here]
        if len(there) == 0 or len(asked) == 0:
            continue
        places = np.concatenate([halves.centre[there], halves.far * halves.normal[there]], axis=1)
        centres = reflection.of_points(halves.centre[asked])
        images = np.concatenate([centres, halves.far * reflection.of_directions(halves.normal[asked])], axis=1)
        result[here] = there[KDTree(places).query(images)[1]]
    return result


def _partners(component: IntArray, image: IntArray, areas: FloatArray) -> IntArray | None:
    """(C,) the component that has most of the image of every component.

    A negligible component whose partner has another partner is its own one. If there is such a component that is not
    negligible, there are no partners.

    Parameters
    ----------
    component, image : (F,) the component of every face, and that of its image.
    """
    count = int(component.max()) + 1
    partner = largest_options(np.arange(count, dtype=np.int32), component, image, areas)
    is_alone = partner[partner] != np.arange(count)
    if (is_alone & (group_sums(component, areas) > NEGLIGIBLE * areas.sum())).any():
        return None
    return np.where(is_alone, np.arange(count), partner).astype(np.int32)
