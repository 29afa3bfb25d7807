import numpy as np
import pytest

import segcore
from helpers.bodies.creatures import LIMBS, creature, limb_of_face
from helpers.meshes import agreement, areas, exploded, pieces_of_labels
from segcore import shapes
from segcore.edit import guide as guide_module
from segcore.errors import InvalidParameters
from segcore.parameters import SegmentationParameters

MESH = creature()
LIMB = limb_of_face(MESH)
AREAS = areas(MESH)
CENTRES = MESH.corners.mean(axis=1)


@pytest.fixture(scope="module")
def hierarchy():
    return segcore.segment(MESH)


@pytest.fixture(scope="module")
def guide(hierarchy):
    return segcore.Guide(MESH, hierarchy)


def tip(limb):
    """The face of a limb that is farthest from the middle of the body."""
    faces = np.flatnonzero(limb == LIMB)
    return int(faces[np.argmax(np.linalg.norm(CENTRES[faces], axis=1))])


def iou(found, wanted):
    return AREAS[found & wanted].sum() / AREAS[found | wanted].sum()


def border_length(mesh, labels):
    edges = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(labels, 3)
    order = np.lexsort(edges.T)
    first, second = order[::2], order[1::2]
    ends = mesh.vertices[edges[first]]
    length = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    return length[owner[first] != owner[second]].sum()


@pytest.mark.parametrize("limb", range(1, 8))
def test_one_click_on_a_limb_is_the_limb(guide, limb):
    assert iou(guide.part([tip(limb)]), limb == LIMB) > 0.8


def test_a_second_click_on_another_limb_and_one_on_the_body_is_all_of_them(guide):
    part = guide.part([tip(1), tip(2)])
    assert part[[tip(1), tip(2)]].all()
    both = (LIMB == 1) | (LIMB == 2)
    assert iou(part, both) > 0.8
    middle = int(np.argmin(np.linalg.norm(CENTRES - CENTRES[LIMB == 0].mean(axis=0), axis=1)))
    assert guide.part([tip(1), middle])[middle]


def test_a_click_outside_takes_a_limb_away(guide):
    whole = guide.part([tip(1), tip(2), tip(3)])
    without = guide.part([tip(1), tip(2), tip(3)], [tip(4)])
    assert not without[tip(4)]
    assert without[[tip(1), tip(2), tip(3)]].all()
    assert AREAS[without].sum() <= AREAS[whole].sum()


def test_marks_are_obeyed_and_the_result_depends_on_the_arguments_alone(guide, hierarchy):
    rng = np.random.default_rng(0)
    asked = []
    for _ in range(12):
        faces = rng.choice(len(MESH.faces), 6, replace=False)
        count = int(rng.integers(1, 6))
        part = guide.part(faces[:count], faces[count:])
        assert part[faces[:count]].all()
        assert not part[faces[count:]].any()
        asked.append((faces, count, part))
    fresh = segcore.Guide(MESH, hierarchy)
    for faces, count, part in reversed(asked):
        np.testing.assert_array_equal(fresh.part(faces[:count], faces[count:]), part)


def test_a_stroke_along_a_limb_is_the_limb(guide):
    faces = np.flatnonzero(LIMB == 2)
    stroke = faces[np.argsort(np.linalg.norm(CENTRES[faces], axis=1))][:: len(faces) // 30]
    part = guide.part(stroke)
    assert part[stroke].all()
    assert iou(part, LIMB == 2) > 0.8


def test_faces_that_share_no_vertices_in_the_file_are_one_surface(hierarchy):
    apart = exploded(MESH)
    found = segcore.Guide(apart, hierarchy).part([tip(3)])
    assert iou(found, LIMB == 3) > 0.8


def test_parts_of_several_bodies_are_found():
    bodies = shapes.joined(shapes.box(), shapes.box(centre=(1.001, 0.0, 0.0)), shapes.icosphere(3)).mesh
    assembly = segcore.segment(bodies)
    guide = segcore.Guide(bodies, assembly)
    first = guide.part([0])
    last = guide.part([len(bodies.faces) - 1])
    assert first[0]
    assert last[-1]
    assert not (first & last).any()
    assert guide.part([0, len(bodies.faces) - 1])[[0, -1]].all()


def test_above_a_number_of_faces_borders_of_clusters_are_drawn_on_the_faces(guide, hierarchy, monkeypatch):
    monkeypatch.setattr(guide_module, "_MOST_NODES", 1500)
    coarse = segcore.Guide(MESH, hierarchy)
    for limb in range(1, 8):
        part = coarse.part([tip(limb)])
        assert iou(part, guide.part([tip(limb)])) > 0.9
        assert pieces_of_labels(MESH, part.astype(np.int32)) == 2
    marks = np.random.default_rng(1).choice(len(MESH.faces), 5, replace=False)
    part = coarse.part(marks[:2], marks[2:])
    assert part[marks[:2]].all()
    assert not part[marks[2:]].any()


def test_a_border_without_a_stroke_goes_to_the_concavity_nearby(guide):
    wanted = (LIMB == 1).astype(np.int32)
    middle = CENTRES[LIMB == 1].mean(axis=0)
    shifted = np.linalg.norm(CENTRES - middle, axis=1) < 1.1 * np.linalg.norm(CENTRES[LIMB == 1] - middle, axis=1).max()
    labels = (shifted & np.isin(LIMB, (0, 1))).astype(np.int32)
    found = guide.border(labels, 0, 1)
    assert iou(found == 1, wanted == 1) > iou(labels == 1, wanted == 1)
    assert iou(found == 1, wanted == 1) > 0.9


def ring_around(limb, faces):
    """Some faces of a ring around a limb, in the order of the angle."""
    axis = CENTRES[limb == LIMB].mean(axis=0)
    axis /= np.linalg.norm(axis)
    first = np.cross(axis, [0.3, 0.2, 1.0])
    second = np.cross(axis, first) / np.linalg.norm(first)
    first /= np.linalg.norm(first)
    angle = np.arctan2(CENTRES[faces] @ second, CENTRES[faces] @ first)
    return faces[np.argsort(angle)]


def test_a_border_follows_a_stroke(guide):
    reach = np.linalg.norm(CENTRES, axis=1)
    middle = np.median(reach[LIMB == 1])
    stroke = ring_around(1, np.flatnonzero((LIMB == 1) & (np.abs(reach - middle) < 0.15)))[::3]
    found = guide.border((LIMB == 1).astype(np.int32), 0, 1, [*stroke, stroke[0]])
    assert (found[stroke] == 0).all()
    assert (found[(LIMB == 1) & (reach < middle - 0.3)] == 0).all()
    assert (found[(LIMB == 1) & (reach > middle + 0.6)] == 1).all()
    assert reach[LIMB == 1].max() > middle + 0.7


def test_a_stroke_beside_a_border_moves_it_there_and_no_farther(guide):
    labels = LIMB.astype(np.int32)
    reach = np.linalg.norm(CENTRES, axis=1)
    stroke = ring_around(1, np.flatnonzero((LIMB == 1) & (np.abs(reach - np.median(reach[LIMB == 1])) < 0.03)))[:8]
    found = guide.border(labels, 0, 1, stroke)
    assert (found[stroke] == 0).all()
    assert found[tip(1)] == 1
    assert (found == 1).sum() < (labels == 1).sum()
    np.testing.assert_array_equal(found[labels > 1], labels[labels > 1])


def test_jagged_borders_become_short_and_other_parts_stay(guide):
    rng = np.random.default_rng(3)
    labels = np.where(LIMB < 3, LIMB, 0).astype(np.int32)
    neighbours = np.zeros(len(labels), dtype=bool)
    edges = segcore.build_surface(MESH).edge_faces
    neighbours[edges[labels[edges[:, 0]] != labels[edges[:, 1]]]] = True
    jagged = labels.copy()
    noisy = np.flatnonzero(neighbours & (rng.random(len(labels)) < 0.4))
    jagged[noisy] = np.where(labels[noisy] == 0, 1, 0)
    smooth = guide.smooth(jagged, [0, 1])
    assert border_length(MESH, smooth) < 0.9 * border_length(MESH, jagged)
    np.testing.assert_array_equal(smooth == 2, jagged == 2)
    assert agreement(guide.smooth(jagged), labels, AREAS) > 0.97


def test_smoothing_keeps_all_parts(guide):
    labels = np.arange(len(MESH.faces), dtype=np.int32) % 50
    assert set(guide.smooth(labels).tolist()) == set(range(50))


def test_a_part_is_divided_along_a_stroke(guide):
    whole = np.zeros(len(MESH.faces), dtype=np.int32)
    towards = CENTRES / np.linalg.norm(CENTRES, axis=1, keepdims=True) @ LIMBS[0]
    ring = ring_around(1, np.flatnonzero((LIMB == 1) & (towards < 0.88)))
    found = guide.cut(whole, 0, ring[: len(ring) // 2 : 3])
    assert set(found.tolist()) == {0, 1}
    assert iou(found == 1, LIMB == 1) > 0.75
    assert pieces_of_labels(MESH, found) == 2


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda guide: guide.part([]), "at least one face"),
        (lambda guide: guide.part([len(MESH.faces)]), "There is no face"),
        (lambda guide: guide.part([0], [-1]), "There is no face -1"),
        (lambda guide: guide.part([0, 1], [1]), "both inside and outside"),
        (lambda guide: guide.border(LIMB, 0, 99), "There is no part 99"),
        (lambda guide: guide.border(LIMB, 1, 2), "no common border"),
        (lambda guide: guide.border(LIMB, 1, 1), "no common border"),
        (lambda guide: guide.border(LIMB, 0, 1, [tip(2)]), "no face of the parts 0 and 1"),
        (lambda guide: guide.smooth(LIMB[:-1]), "a label for each"),
        (lambda guide: guide.smooth(LIMB, [77]), "There is no part 77"),
        (lambda guide: guide.cut(LIMB, 1, [tip(2)]), "Draw it across"),
        (lambda guide: guide.cut(LIMB, 88, [tip(2)]), "There is no part 88"),
    ],
)
def test_wrong_arguments_are_explained(guide, call, message):
    with pytest.raises(InvalidParameters, match=message):
        call(guide)


def test_a_hierarchy_of_the_vertex_graph_is_corrected_too():
    mesh = creature(subdivisions=3)
    hierarchy = segcore.segment(mesh, SegmentationParameters.from_mapping({"preset": "chahhou2014"}))
    part = segcore.Guide(mesh, hierarchy).part([5], [200])
    assert part[5]
    assert not part[200]


def test_a_hierarchy_of_another_mesh_is_refused(hierarchy):
    with pytest.raises(InvalidParameters, match="mesh of"):
        segcore.Guide(shapes.icosphere(2), hierarchy)


@pytest.mark.parametrize(
    "vertices",
    [
        [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        [[0, 0, 0], [1, 0, 0], [2, 0, 0]],
        [[0, 0, 0], [0, 0, 0], [0, 0, 0]],
    ],
)
def test_a_mesh_of_one_face_has_one_part(vertices):
    mesh = segcore.Mesh(np.array(vertices, dtype=float), np.array([[0, 1, 2]], dtype=np.int32))
    guide = segcore.Guide(mesh, segcore.segment(mesh))
    assert guide.part([0]).tolist() == [True]
    assert guide.smooth(np.zeros(1, dtype=np.int32)).tolist() == [0]
