"""Links through thin walls: both faces of a plate belong to one part."""

from dataclasses import replace

import numpy as np

from segcore.arrays import group_sums
from segcore.coarsen.clusters import Clusters
from segcore.graphs.mesh_graph import Opposites
from segcore.graphs.surface_graph import SurfaceGraph

# Set by hand; decision 29 compares neighbours of the second.
_LINK = 0.1  # border that a wall of unit area over unit thickness counts as
_THIN = 0.1  # largest thickness of a wall in the square root of the area of its body
_THINNEST = 1e-3  # thickness below which a wall counts as no thinner: keeps the weights of touching faces finite


def with_opposites(clusters: Clusters, opposites: Opposites | None) -> Clusters:
    """Clusters with edges between those on opposite faces of thin walls of one body.

    To separate both faces of a wall of area A and thickness t is to cut it along its middle, which counts as a border
    of length 0.1 A / t and affinity 1. A wall is thin up to 0.1 times the square root of the area of its body: links
    through the length of a body would connect what lies apart.

    Parameters
    ----------
    opposites : of the nodes of the mesh graph; None adds no edges.
    """
    if opposites is None:
        return clusters
    graph, body = clusters.graph, clusters.body
    size = np.sqrt(group_sums(body, graph.volume))
    ends = clusters.of_node[opposites.nodes]
    own = size[body[ends[:, 0]]]
    inside = (ends[:, 0] != ends[:, 1]) & (body[ends[:, 0]] == body[ends[:, 1]]) & (opposites.distance <= _THIN * own)
    if not inside.any():
        return clusters
    thickness = np.maximum(opposites.distance[inside], _THINNEST * own[inside])
    border = 0.5 * _LINK * opposites.area[inside] / thickness  # every pair is met from both sides
    linked = SurfaceGraph.with_sums(
        np.concatenate([graph.edges, ends[inside]]),
        np.concatenate([graph.weight, border]),
        graph.volume,
        np.concatenate([graph.length, border]),
    )
    return replace(clusters, graph=linked)
