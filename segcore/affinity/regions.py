"""Regions that the faces of a surface are divided into: their areas, and their outlines."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.clean.surface import Surface
from segcore.graphs.surface_graph import connected_components


class Regions(NamedTuple):
    """R regions, in each of which all faces lie in one component of the surface."""

    area: FloatArray  # (R,)
    of_component: FloatArray  # (R,) the area of the component in which a region lies
    ends: IntArray  # (E, 2) the regions at the dual edges
    at_outline: BoolArray  # (E,) True for the dual edges between two regions

    def outline_sums(self, values: FloatArray) -> FloatArray:
        """(R,) the sum along the outline of every region of values (N,) at the dual edges of outlines."""
        a, b = self.ends[self.at_outline].T
        return group_sums(a, values, len(self.area)) + group_sums(b, values, len(self.area))


def component_areas(surface: Surface) -> FloatArray:
    """(F,) the area of the component that every face lies in."""
    component = connected_components(surface.edge_faces, len(surface.faces))
    return group_sums(component, surface.areas)[component]


def regions_of(surface: Surface, region: IntArray, in_component: FloatArray) -> Regions:
    """The regions of a surface.

    Parameters
    ----------
    region : (F,) the region 0, 1, ... of every face.
    in_component : (F,) ``component_areas(surface)``.
    """
    area = group_sums(region, surface.areas)
    of_component = np.zeros(len(area))
    of_component[region] = in_component
    ends = region[surface.edge_faces]
    return Regions(area, of_component, ends, ends[:, 0] != ends[:, 1])
