import numpy as np
import pytest

from segcore import shapes
from segcore.clean.surface import build_surface
from segcore.cut.fields import ClusterFields, cluster_fields
from segcore.mesh import Mesh
from segcore.method import coarse_graph
from segcore.parameters import SegmentationParameters


def fields_of(mesh: Mesh) -> ClusterFields:
    """The fields of the clusters of a mesh."""
    parameters = SegmentationParameters()
    coarse = coarse_graph(build_surface(mesh), parameters, np.random.default_rng(0), is_symmetric=False)
    return cluster_fields(coarse.refinement.surface, coarse.clusters, coarse.links)


@pytest.mark.parametrize(("gap", "sign"), [(0.005, 1.0), (-0.02, -1.0)])
def test_contacts_are_concave_or_convex_and_other_edges_are_neither(gap: float, sign: float) -> None:
    fields = fields_of(shapes.joined(shapes.box(), shapes.box((1, 1, 1), (1.0 + gap, 0, 0))).mesh)
    ends = fields.bodies.of_cluster[fields.graph.edges]
    is_contact = ends[:, 0] != ends[:, 1]
    assert is_contact.any()
    length = fields.graph.length[is_contact]
    assert sign * (length @ fields.concavity[is_contact]) > 0.1 * length.sum()
    assert not fields.concavity[~is_contact].any()


def test_one_body_has_no_contacts() -> None:
    assert not fields_of(shapes.burr(3).mesh).concavity.any()
