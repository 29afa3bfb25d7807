import numpy as np
import pytest

from segcore import shapes
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.surface import build_surface
from segcore.parameters import SegmentationParameters
from segcore.solvers.solvers import SOLVERS

NECK, AROUND = 0.3, 32
DUMBBELL = shapes.dumbbell(rings=60, around=AROUND, neck=NECK)


@pytest.mark.parametrize("solver", sorted(SOLVERS))
def test_every_solver_cuts_a_dumbbell_around_its_neck(solver):
    """The least cut is a ring of the neck, a polygon, and each side has half of the area."""
    parameters = SegmentationParameters(affinity="adjacency", solver=solver, starts=2)
    surface = build_surface(DUMBBELL.mesh)
    graph = mesh_graph(surface, parameters).graph
    cut = SOLVERS[solver](graph, parameters, np.random.default_rng(0))
    ring = 2 * AROUND * NECK * np.sin(np.pi / AROUND) / surface.unit
    assert cut.ncc == pytest.approx(ring / (surface.areas.sum() / 2), rel=0.05)
    assert len(set(cut.side[DUMBBELL.parts == 0])) == len(set(cut.side[DUMBBELL.parts == 1])) == 1
    assert cut.side[DUMBBELL.parts == 0][0] != cut.side[DUMBBELL.parts == 1][0]
