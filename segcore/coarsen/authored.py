"""The authored structure: parts that the file names, which the first splits of a hierarchy separate."""

from dataclasses import replace

import numpy as np

from segcore.array_kernels import face_centroids
from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.clean.surface import Surface
from segcore.coarsen.components import group_by_nearness, largest, nearest_hosts
from segcore.errors import InvalidParameters
from segcore.graphs.surface_graph import connected_components
from segcore.mesh import Mesh, face_normals_and_areas
from segcore.parameters import Structure
from segcore.structure import FileStructure

MOST_AUTHORED = 10_000  # parts, the largest ``max_segments``; others are merged with the nearest of these
_FAR = 4.0  # more than the distance of any two points of a surface, whose extent is 1


def with_structure(surface: Surface, mesh: Mesh, structure: Structure) -> Surface:
    """A surface that is not connected across the authored parts of a mesh.

    ``authored`` of the result is the part of every face, and the dual edges between different parts are left out. If
    there are more than 10,000 parts, all but the largest are merged with the nearest of them. If there is one part, or
    none is asked for, the surface is returned as it is.

    Raises
    ------
    InvalidParameters
        If the file has no such structure.
    """
    if structure == "none":
        return surface
    part = authored_parts(surface, mesh, structure)
    if part is None:
        raise InvalidParameters(f"This file has no {structure}: use structure=shells, or structure=none.")
    if part.max() == 0:
        return surface
    part = _at_most(surface, part, MOST_AUTHORED)
    inside = part[surface.edge_faces[:, 0]] == part[surface.edge_faces[:, 1]]
    return replace(
        surface, edge_faces=surface.edge_faces[inside], edge_vertices=surface.edge_vertices[inside], authored=part
    )


def authored_parts(surface: Surface, mesh: Mesh, structure: Structure) -> IntArray | None:
    """(F,) the part 0..P - 1 of every face of a surface; None if the file has no such structure.

    A shell is a connected component of the surface. Faces without a group, or without a material, are one more part.
    """
    if structure == "shells":
        return connected_components(surface.edge_faces, len(surface.faces))
    file = mesh.structure or FileStructure()
    entries = file.group if structure == "groups" else file.material
    if entries is None:
        return None
    return np.unique(entries[_first_of_input(surface, mesh)], return_inverse=True)[1].astype(np.int32)


def _first_of_input(surface: Surface, mesh: Mesh) -> IntArray:
    """(F,) the input face of largest area that every face of a surface represents, the first one of several."""
    represented = surface.face_of_input
    if len(surface.faces) == len(represented):
        return np.argsort(represented).astype(np.int32)
    areas = face_normals_and_areas(mesh.corners)[1]
    order = np.lexsort((-areas, represented))
    first = np.unique(represented[order], return_index=True)[1]
    return order[first].astype(np.int32)


def _at_most(surface: Surface, part: IntArray, most: int) -> IntArray:
    """(F,) parts in which all but the ``most`` largest are merged with the nearest of these."""
    is_host = largest(part, surface.areas, most)
    if is_host.all():
        return part
    merged = np.arange(len(is_host), dtype=np.int32)
    pairs = nearest_hosts(part, is_host, face_centroids(surface.vertices, surface.faces))
    merged[part[pairs[:, 0]]] = part[pairs[:, 1]]
    return np.unique(merged[part], return_inverse=True)[1].astype(np.int32)


def apart(points: FloatArray, part: IntArray | None) -> FloatArray:
    """(P, 3 or 4) points with one more coordinate, such that points of different parts are never the nearest.

    Parameters
    ----------
    points : (P, 3) points of a surface of extent 1.
    part : (P,) the authored part of every point; None returns the points as they are.
    """
    return points if part is None else np.column_stack([points, _FAR * part])


def largest_of_each_part(component: IntArray, areas: FloatArray, part: IntArray | None) -> BoolArray:
    """(C,) True for the largest component of every authored part; False for all if ``part`` is None.

    Parameters
    ----------
    component : (P,) the component 0..C - 1 of every point, face or node.
    areas : (P,)
    part : (P,) the authored part of every point; a component lies in one part.
    """
    area = group_sums(component, areas)
    chosen = np.zeros(len(area), dtype=bool)
    if part is None:
        return chosen
    of_component = part_of_component(component, part)
    order = np.lexsort((-area, of_component))
    chosen[order[np.unique(of_component[order], return_index=True)[1]]] = True
    return chosen


def part_of_component(component: IntArray, part: IntArray) -> IntArray:
    """(C,) the authored part of every component."""
    of_component = np.empty(int(component.max()) + 1, dtype=np.int32)
    of_component[component] = part
    return of_component


def group_by_part(points: FloatArray, component: IntArray, part: IntArray | None) -> IntArray:
    """The merges of ``group_by_nearness``: first those within the authored parts, then those of the parts.

    Parameters
    ----------
    points : (P, 3), at least one for every component.
    component : (P,) the component 0..C - 1 of every point.
    part : (P,) the authored part of every point; None if there are none.

    Returns
    -------
    (C - 1, 2) pairs of groups; groups 0..C - 1 are the components, merge i makes group C + i.
    """
    if part is None:
        return group_by_nearness(points, component)
    of_component = part_of_component(component, part)
    count, parts = len(of_component), int(of_component.max()) + 1
    within = group_by_nearness(apart(points, part), component)[: count - parts]
    of_group = np.concatenate([of_component, np.zeros(len(within), dtype=np.int32)])
    for i, (one, _) in enumerate(within.tolist()):
        of_group[count + i] = of_group[one]
    group = np.zeros(parts, dtype=np.int32)
    np.maximum.at(group, of_group, np.arange(len(of_group), dtype=np.int32))  # the last one has all of the part
    above = group_by_nearness(points, part)
    is_merge = above >= parts
    above[~is_merge] = group[above[~is_merge]]
    above[is_merge] += count + len(within) - parts
    return np.concatenate([within, above])
