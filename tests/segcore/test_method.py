import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from helpers.bodies.creatures import creature, limb_of_face, mirrored_labels
from helpers.meshes import agreement, areas, exploded, pieces_of_labels, rotation
from segcore import shapes
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters

BURR = shapes.burr(4)
DUMBBELL = shapes.dumbbell(rings=60, around=32)


@pytest.mark.parametrize("shape", [shapes.burr(5), shapes.burr(5, arms=3), shapes.dumbbell()])
def test_the_parts_of_a_shape_are_found(shape):
    hierarchy = segment(shape.mesh)
    labels = hierarchy.labels(int(shape.parts.max()) + 1)
    assert agreement(labels, shape.parts, areas(shape.mesh)) > 0.95


@pytest.mark.parametrize("shape", [shapes.burr(5), shapes.burr(5, arms=3), shapes.dumbbell()])
def test_the_automatic_number_is_that_of_the_parts(shape):
    assert segment(shape.mesh).automatic_segments == shape.parts.max() + 1


def test_more_shells_than_have_clusters_of_their_own_leave_the_large_ones_apart():
    """A base with two posts on 1,100 pins; the faces of the base and of the posts are divided for the computation."""
    places = np.stack(np.meshgrid(np.arange(34), np.arange(34)), axis=-1).reshape(-1, 2)[:1100] / 34 - 0.485
    pins = [shapes.box((0.015, 0.015, 0.015), (x, y, -0.507)) for x, y in places]
    posts = [shapes.box((0.3, 0.3, 1.5), (x, x, 1.24)) for x in (-0.3, 0.2)]
    hierarchy = segment(shapes.joined(shapes.box(), *posts, *pins).mesh)
    assert hierarchy.max_segments > 900
    labels = hierarchy.labels(3)[:36].reshape(3, 12)
    assert (labels == labels[:, :1]).all()
    assert len(set(labels[:, 0])) == 3


@pytest.mark.parametrize("mesh", [BURR.mesh, DUMBBELL.mesh, shapes.icosphere(3), shapes.box()])
def test_every_segment_at_every_level_is_connected(mesh):
    hierarchy = segment(mesh)
    for k in range(1, min(hierarchy.max_segments, 30) + 1):
        assert pieces_of_labels(mesh, hierarchy.labels(k)) == k


@pytest.mark.parametrize("scale", [1e-15, 1e-20])
def test_a_copy_far_smaller_than_the_rounding_of_a_shape_changes_nothing(scale):
    speck = Mesh(scale * BURR.mesh.vertices, BURR.mesh.faces)
    with np.errstate(all="raise", under="ignore"):
        labels = segment(shapes.joined(BURR.mesh, speck).mesh).labels(7)[: len(BURR.mesh.faces)]
    assert agreement(labels, BURR.parts, areas(BURR.mesh)) > 0.95


def test_the_same_mesh_gives_the_same_bytes():
    first, second = segment(BURR.mesh), segment(BURR.mesh)
    for name in ("split_node", "cut_value", "area", "face_count", "face_leaf"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()


def test_areas_and_faces_of_the_parts_add_up():
    hierarchy = segment(BURR.mesh)
    np.testing.assert_allclose(hierarchy.area[0], areas(BURR.mesh).sum())
    assert hierarchy.face_count[0] == len(BURR.mesh.faces)
    labels = hierarchy.labels(7)
    nodes = hierarchy.segment_nodes(7)
    np.testing.assert_allclose(hierarchy.area[nodes], np.bincount(labels, areas(BURR.mesh)))
    np.testing.assert_array_equal(hierarchy.face_count[nodes], np.bincount(labels))


def test_the_larger_part_keeps_the_label():
    hierarchy = segment(BURR.mesh)
    assert (hierarchy.area[1::2] >= hierarchy.area[2::2] * (1 - 1e-6)).all()


@pytest.mark.parametrize("seed", range(3))
def test_labels_do_not_change_under_rigid_motion_and_scale(seed):
    rng = np.random.default_rng(seed)
    moved = Mesh(10 ** rng.uniform(-4, 4) * (BURR.mesh.vertices @ rotation(rng) + rng.normal(size=3)), BURR.mesh.faces)
    assert agreement(segment(moved).labels(7), segment(BURR.mesh).labels(7), areas(BURR.mesh)) > 0.98


@pytest.mark.parametrize("seed", range(3))
def test_parts_do_not_depend_on_the_order_and_the_orientation_of_the_faces(seed):
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(BURR.mesh.faces))
    faces = np.where(rng.random(len(order))[:, None] < 0.5, BURR.mesh.faces[:, ::-1], BURR.mesh.faces)[order]
    labels = segment(Mesh(BURR.mesh.vertices, faces)).labels(7)
    assert agreement(labels, BURR.parts[order], areas(BURR.mesh)[order]) > 0.95


def test_a_soup_of_triangles_gets_the_parts_of_the_welded_mesh():
    labels = segment(exploded(BURR.mesh)).labels(7)
    assert agreement(labels, segment(BURR.mesh).labels(7), areas(BURR.mesh)) > 0.98


def test_repeated_and_degenerate_faces_get_the_labels_of_their_neighbours():
    faces = BURR.mesh.faces
    lines = np.stack([faces[:50, 0], faces[:50, 0], faces[:50, 1]], axis=1)
    dirty = Mesh(BURR.mesh.vertices, np.concatenate([faces[:100, ::-1], faces, lines]))
    labels = segment(dirty).labels(7)
    np.testing.assert_array_equal(labels[:100], labels[100:200])
    assert agreement(labels[100:-50], BURR.parts, areas(BURR.mesh)) > 0.95
    assert pieces_of_labels(Mesh(dirty.vertices, dirty.faces[:-50]), labels[:-50]) == 7


def test_an_open_mesh_gets_its_parts():
    kept = BURR.mesh.corners[:, :, 2].mean(axis=1) > -0.3
    mesh = Mesh(BURR.mesh.vertices, BURR.mesh.faces[kept])
    labels = segment(mesh).labels(6)
    assert agreement(labels, BURR.parts[kept], areas(mesh)) > 0.9


def test_a_face_at_a_non_manifold_edge_is_segmented_with_the_rest():
    a, b = BURR.mesh.faces[0, :2]
    mesh = Mesh(np.concatenate([BURR.mesh.vertices, [[0.0, 0, 9]]]),
                np.concatenate([BURR.mesh.faces, [[a, b, len(BURR.mesh.vertices)]]]))  # fmt: skip
    hierarchy = segment(mesh)
    for k in range(1, 10):
        assert pieces_of_labels(mesh, hierarchy.labels(k)) == k


def test_components_that_lie_apart_are_separated_before_any_cut():
    shape = shapes.joined(DUMBBELL.mesh, shapes.box(centre=(5, 0, 0)), shapes.box(centre=(-3, 0, 0)))
    hierarchy = segment(shape.mesh)
    labels = hierarchy.labels(3)
    assert agreement(labels, shape.parts, areas(shape.mesh)) == pytest.approx(1)
    assert (hierarchy.cut_value[:2] == 0).all()
    assert (hierarchy.cut_value[2:] > 0).all()


def test_fewer_segments_than_components_group_the_near_ones():
    boxes = [shapes.box(centre=(x, 0, 0)) for x in (0, 1.5, 10, 11.5, 30)]
    hierarchy = segment(shapes.joined(*boxes).mesh)
    groups = [hierarchy.labels(k).reshape(5, 12)[:, 0].tolist() for k in (2, 3)]
    assert len(set(groups[0][:4])) == 1
    assert groups[0][4] != groups[0][0]
    assert groups[1][0] == groups[1][1] != groups[1][2] == groups[1][3] != groups[1][4]


def test_a_thousand_components_end_in_a_hierarchy_of_the_requested_size():
    rng = np.random.default_rng(0)
    large = [shapes.icosphere(2, 5.0), shapes.box((5, 5, 5), (20, 0, 0))]
    dust = [shapes.box((0.1, 0.1, 0.1), tuple(rng.uniform(-5, 25, 3))) for _ in range(998)]
    shape = shapes.joined(*large, *dust)
    hierarchy = segment(shape.mesh, SegmentationParameters(max_segments=20))
    assert hierarchy.max_segments == 20
    labels = hierarchy.labels(2)
    assert labels[0] != labels[320]
    assert len(set(labels[:320])) == len(set(labels[320:332])) == 1


@pytest.mark.parametrize("most", [1, 2, 9])
def test_the_hierarchy_ends_at_the_requested_number_of_segments(most):
    hierarchy = segment(BURR.mesh, SegmentationParameters(max_segments=most))
    assert hierarchy.max_segments == most
    assert set(hierarchy.labels(most)) == set(range(most))


def test_as_many_components_as_segments_are_all_separated():
    boxes = shapes.joined(*[shapes.box(centre=(2.0 * (x % 8), 2.0 * (x // 8), 0)) for x in range(64)])
    labels = segment(boxes.mesh).labels(64)
    np.testing.assert_array_equal(labels.reshape(64, 12).min(axis=1), labels.reshape(64, 12).max(axis=1))


def test_components_beyond_the_number_of_segments_share_them():
    boxes = shapes.joined(*[shapes.box(centre=(2.0 * x, 0, 0)) for x in range(5)]).mesh
    for most in (1, 2, 3):
        assert segment(boxes, SegmentationParameters(max_segments=most)).max_segments == most


@pytest.mark.parametrize(("mesh", "most"), [(shapes.box(), 12), (Mesh(np.eye(3), [[0, 1, 2]]), 1),
                                            (Mesh(np.ones((3, 3)), [[0, 1, 2], [0, 0, 0]]), 1)])  # fmt: skip
def test_small_meshes_have_at_most_as_many_segments_as_faces_with_an_area(mesh, most):
    """Splits of divided faces that no whole face follows are left out: at least the sides of the box are separated."""
    hierarchy = segment(mesh, SegmentationParameters(max_segments=64))
    assert most / 2 <= hierarchy.max_segments <= most
    assert len(np.unique(hierarchy.labels(hierarchy.max_segments))) == hierarchy.max_segments


def test_no_cut_of_a_profile_runs_across_its_flat_sides():
    """An L of 4 x 4, its legs 0.4 thick, 15 long, of 20 long triangles: the cut runs along the inner corner."""
    outline = np.array([[0, 0], [4, 0], [4, 0.4], [0.4, 0.4], [0.4, 4], [0, 4]])
    vertices = np.concatenate([np.insert(outline, 2, z, axis=1) for z in (0.0, 15.0)])
    caps = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
    sides = [f for i in range(6) for f in ([i, (i + 1) % 6, 6 + (i + 1) % 6], [i, 6 + (i + 1) % 6, 6 + i])]
    mesh = Mesh(vertices, np.array([c[::-1] for c in caps] + [[6 + v for v in c] for c in caps] + sides))
    labels = segment(mesh).labels(2)
    pairs = labels[8:].reshape(6, 2)
    np.testing.assert_array_equal(pairs[:, 0], pairs[:, 1])
    assert pairs[2, 0] != pairs[3, 0]


def test_progress_runs_from_0_to_1():
    reported = []
    segment(BURR.mesh, on_progress=lambda stage, fraction: reported.append((stage, fraction)))
    fractions = [fraction for _, fraction in reported]
    assert fractions[0] == 0
    assert fractions[-1] == 1
    assert fractions == sorted(fractions)
    assert [stage for i, (stage, _) in enumerate(reported) if i == 0 or reported[i - 1][0] != stage] == [
        "clean", "affinity", "coarsen", "cut", "label"]  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(npst.arrays(np.int32, st.tuples(st.integers(1, 20), st.just(3)), elements=st.integers(0, 7)), st.data())
def test_whatever_the_faces_every_one_gets_a_label(faces, data):
    coordinate = st.sampled_from([0.0, 1.0, -1.0, 0.5, 1e-20, 1e20])
    mesh = Mesh(data.draw(npst.arrays(np.float64, (8, 3), elements=coordinate)), faces)
    hierarchy = segment(mesh)
    for k in {1, hierarchy.automatic_segments, hierarchy.max_segments}:
        labels = hierarchy.labels(k)
        assert labels.shape == (len(faces),)
        np.testing.assert_array_equal(np.unique(labels), np.arange(k))


@pytest.mark.filterwarnings("ignore:overflow encountered in dot:RuntimeWarning")
def test_vertices_that_are_all_but_equal_give_every_face_a_label():
    """Masses of patches are lost in rounding here, so that the matrix of the smoothing is singular."""
    vertices = np.array(
        [[0, -1, -1], [1e-20, -1, -1], *[[-1, -1, -1]] * 2, [-1, 0, -1], [1, -1, -1], *[[-1, -1, -1]] * 2]
    )
    faces = np.array([[3, 7, 4], [6, 5, 0], [1, 0, 4], [5, 3, 3], [7, 5, 6], [3, 5, 1]])
    assert len(segment(Mesh(vertices.astype(float), faces)).labels()) == len(faces)


@pytest.mark.parametrize("turn", [None, rotation(np.random.default_rng(4))])
@pytest.mark.parametrize("affinity", ["learned", "concavity"])
def test_a_symmetric_body_gets_symmetric_parts_whatever_its_meshing(turn, affinity):
    mesh = creature(turn, subdivisions=5)
    result = segment(mesh, SegmentationParameters(affinity=affinity))
    labels = result.labels()
    assert agreement(labels, limb_of_face(mesh), areas(mesh)) > 0.95
    assert agreement(labels, mirrored_labels(mesh, labels), areas(mesh)) > (0.998 if turn is None else 0.98)


def test_the_presets_of_the_paper_know_no_symmetry():
    assert SegmentationParameters().is_symmetric
    assert SegmentationParameters(affinity="concavity", order="ncut").is_symmetric
    for other in ({"preset": "chahhou2014"}, {"affinity": "minima_rule"}, {"order": "ncc"}, {"order": "volume"}):
        assert not SegmentationParameters.from_mapping(other).is_symmetric


def sheet(height):
    """An open sheet of 40 x 40 vertices over a square, with a height over x and y."""
    steps = np.linspace(-1, 1, 40)
    x, y = (c.ravel() for c in np.meshgrid(steps, steps))
    corner = np.arange(1600).reshape(40, 40)
    a, b, c, d = (corner[i : 39 + i, j : 39 + j].ravel() for i in (0, 1) for j in (0, 1))
    return Mesh(np.stack([x, y, height(x, y)], axis=1), np.concatenate([np.stack([a, b, d]).T, np.stack([a, d, c]).T]))


@pytest.mark.parametrize("depth", [0.0, 0.05, 0.1])
def test_an_open_sheet_without_real_concavity_is_one_part(depth):
    assert segment(sheet(lambda x, y: depth * np.sin(3 * x) * np.cos(2 * y))).automatic_segments == 1


def test_a_ball_on_a_plane_in_a_range_map_is_a_part():
    hierarchy = segment(sheet(lambda x, y: np.sqrt(np.maximum(0.4 - x**2 - y**2, 0.0))))
    assert hierarchy.automatic_segments == 2
