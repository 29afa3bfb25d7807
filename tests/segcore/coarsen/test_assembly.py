import numpy as np
import pytest

from helpers.meshes import agreement, areas, moved, refined
from segcore import shapes
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters

box = shapes.box


def chair(gap=0.0, times=0):
    """A seat, four legs, two posts with four slats between them and two bars between legs: 13 boxes."""
    legs = [box((0.05, 0.42, 0.05), (x, 0.215 - gap, z)) for x in (-0.2, 0.2) for z in (-0.2, 0.2)]
    posts = [box((0.05, 0.5, 0.05), (x, 0.725 + gap, -0.2)) for x in (-0.2, 0.2)]
    slats = [box((0.35 - 2 * gap, 0.06, 0.02), (0, y, -0.2)) for y in (0.6, 0.7, 0.8, 0.9)]
    bars = [box((0.03, 0.03, 0.35 - 2 * gap), (x, 0.2, 0)) for x in (-0.2, 0.2)]
    seat = box((0.5, 0.05, 0.5), (0, 0.45, 0))
    return shapes.joined(*[refined(part, times) for part in (seat, *legs, *posts, *slats, *bars)])


def snowman():
    """Three balls and two arms that intersect each other, and three buttons."""
    ball = shapes.icosphere(3)
    balls = [
        Mesh(radius * ball.vertices + [0, y, 0], ball.faces) for radius, y in ((0.5, 0), (0.35, 0.7), (0.22, 1.15))
    ]
    arms = [moved(refined(box((0.5, 0.05, 0.05)), 2), (x, 0.8, 0)) for x in (-0.5, 0.5)]
    buttons = [box((0.02, 0.02, 0.02), (0, y, 0.5 - abs(y))) for y in (-0.1, 0.0, 0.1)]
    return shapes.joined(*balls, *arms, *buttons)


@pytest.mark.parametrize(("gap", "times"), [(0.0, 0), (0.0, 3), (0.003, 2)])
def test_the_back_of_a_chair_of_boxes_is_cut_off_before_its_slats(gap, times):
    shape = chair(gap, times)
    back = (shape.parts >= 5) & (shape.parts < 11)
    labels = segment(shape.mesh).labels(2)
    assert len(set(labels[back])) == 1
    assert labels[back][0] not in labels[~back]


@pytest.mark.parametrize("times", [0, 3])
def test_the_parts_of_a_chair_of_boxes_are_its_boxes(times):
    shape = chair(times=times)
    hierarchy = segment(shape.mesh)
    assert agreement(hierarchy.labels(13), shape.parts, areas(shape.mesh)) > 0.97
    assert (hierarchy.cut_value[:12] > 0).all()


def test_intersecting_shells_are_cut_where_they_cross_and_keep_their_buttons():
    shape = snowman()
    hierarchy = segment(shape.mesh)
    assert 4 <= hierarchy.automatic_segments <= 9
    labels = hierarchy.labels(5)
    assert agreement(labels, np.minimum(shape.parts, 5), areas(shape.mesh)) > 0.95
    assert set(labels[shape.parts >= 5]) <= set(labels[shape.parts < 2])


def test_bodies_that_lie_apart_are_separated_first_and_at_no_cost():
    pair = shapes.joined(chair().mesh, moved(chair().mesh, (3, 0, 0)))
    hierarchy = segment(pair.mesh)
    assert agreement(hierarchy.labels(2), pair.parts, areas(pair.mesh)) == pytest.approx(1)
    assert hierarchy.cut_value[0] == 0
    assert (hierarchy.cut_value[1:] > 0).all()


def test_a_speck_far_away_belongs_to_the_nearest_body():
    ball = shapes.icosphere(3)
    shape = shapes.joined(ball, moved(ball, (5, 0, 0)), box((0.01, 0.01, 0.01), (6.5, 0, 0)))
    labels = segment(shape.mesh).labels(2)
    assert set(labels[shape.parts == 2]) == set(labels[shape.parts == 1]) != set(labels[shape.parts == 0])


@pytest.mark.parametrize("graph", ["faces", "vertices"])
def test_an_assembly_is_cut_on_every_graph(graph):
    shape = chair(times=2)
    parameters = SegmentationParameters(graph=graph, affinity="adjacency", max_segments=4, solver="fiedler")
    hierarchy = segment(shape.mesh, parameters)
    assert hierarchy.max_segments == 4
    assert (hierarchy.cut_value > 0).all()


def test_thousands_of_components_end_in_the_requested_number_of_segments():
    rng = np.random.default_rng(0)
    dust = shapes.joined(*[box((1, 1, 1), tuple(rng.uniform(0, 40, 3))) for _ in range(2000)])
    hierarchy = segment(dust.mesh, SegmentationParameters(max_segments=20))
    assert hierarchy.max_segments == 20
    whole = hierarchy.face_leaf.reshape(2000, 12)
    assert ((whole == whole[:, :1]).all(axis=1)).mean() > 0.9
