import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.placements import FACES, GRAPH, SURFACE, Case, neighbours, side_of
from segcore import shapes
from segcore.array_kernels import face_centroids
from segcore.clean.surface import build_surface
from segcore.label.band import Band, Geometry, band_network, free_faces, grow_band
from segcore.label.leaves import Bounds, FaceGraph

GEOMETRY = Geometry(SURFACE.edge_vertices, SURFACE.vertices, face_centroids(SURFACE.vertices, SURFACE.faces))

cases = st.builds(Case.of, st.integers(2, 12), st.integers(0, 10**6))
seeds = st.integers(0, 10**6)


def plain_band(boundary, side, width):
    """The distance of every face of a band, breadth first, by a queue of faces and the points that they started at."""
    middle = SURFACE.vertices[SURFACE.edge_vertices].mean(axis=1)
    found, queue = {}, []

    def visit(face, start):
        distance = np.linalg.norm(GEOMETRY.centres[face] - start)
        if face not in found and distance <= width:
            found[face] = distance
            queue.append((face, start))

    for edge in boundary:
        for face in GRAPH.edges[edge].tolist():
            visit(face, middle[edge])
    for face, start in queue:
        for other, _ in neighbours(face):
            if side[other] == side[face]:
                visit(other, start)
    return found


@settings(max_examples=40)
@given(cases, seeds, st.floats(0.0, 0.6))
def test_a_band_has_the_faces_that_a_plain_search_finds(case, seed, width):
    """The edges given are all edges of the mesh; those that do not cross the split have no effect."""
    bounds = case.bounds(seed % len(case.tree.split_node))
    side = np.array([side_of(bounds, place) for place in case.place])
    local = np.full(len(side), -1, np.int32)
    edges = np.random.default_rng(seed).permutation(len(GRAPH.edges)).astype(np.int32)
    band = grow_band(edges, FACES, GEOMETRY, case.place, bounds, width, local)
    expected = plain_band([e for e in edges if {*side[GRAPH.edges[e]].tolist()} == {0, 1}], side, width)
    assert (local == -1).all()
    assert band.faces.tolist() == list(expected)
    np.testing.assert_allclose(band.distance, list(expected.values()))


def test_a_band_of_more_faces_than_the_first_arrays_have_room_for():
    """All 1,280 faces of a finer sphere."""
    surface = build_surface(shapes.icosphere(3))
    graph = surface.face_graph()
    faces = FaceGraph(graph.edges, graph.weight, graph.rows())
    geometry = Geometry(surface.edge_vertices, surface.vertices, face_centroids(surface.vertices, surface.faces))
    place = (np.arange(1280) % 2).astype(np.int32)
    local = np.full(1280, -1, np.int32)
    edges = np.arange(len(graph.edges), dtype=np.int32)
    band = grow_band(edges, faces, geometry, place, Bounds(0, 1, 2), 9.0, local)
    assert sorted(band.faces.tolist()) == list(range(1280))


def test_distances_at_a_link_between_components_start_at_the_centres_of_its_faces():
    place = np.zeros(len(GRAPH.volume), np.int32)
    place[7] = 1
    link = GRAPH.with_edges(np.array([[100, 7]]), np.ones(1), np.ones(1))
    faces = FaceGraph(link.edges, link.weight, link.rows())
    local = np.full(len(place), -1, np.int32)
    edges = np.array([len(GRAPH.edges)], np.int32)
    band = grow_band(edges, faces, GEOMETRY, place, Bounds(0, 1, 2), 0.01, local)
    assert band.faces.tolist() == [7, 100]
    assert band.distance.tolist() == [0.0, 0.0]


@settings(max_examples=40)
@given(cases, seeds)
def test_the_free_faces_are_those_outside_the_cores(case, seed):
    rng = np.random.default_rng(seed)
    faces = rng.choice(len(case.place), int(rng.integers(0, len(case.place))), replace=False).astype(np.int32)
    distance = rng.random(len(faces))
    size = np.bincount(case.place, minlength=len(case.split_at))
    pinned = rng.random(len(size)) < 0.2
    leaf = case.place[faces]
    core = pinned[leaf]
    for k in range(len(size)):
        if (leaf == k).sum() == size[k]:
            core |= (leaf == k) & (distance >= 0.5 * distance[leaf == k].max())
    np.testing.assert_array_equal(free_faces(Band(faces, distance), case.place, size, pinned), faces[~core])


@settings(max_examples=40)
@given(cases, seeds)
def test_the_network_of_a_band_has_the_edges_between_free_faces_and_beyond_them(case, seed):
    rng = np.random.default_rng(seed)
    bounds = case.bounds(seed % len(case.tree.split_node))
    side = np.array([side_of(bounds, place) for place in case.place])
    inside = np.flatnonzero(side >= 0)
    free = rng.permutation(inside)[: int(rng.integers(0, len(inside) + 1))].astype(np.int32)
    weight = rng.random(len(GRAPH.edges))
    local, arc_of = np.full(len(side), -1, np.int32), np.full(len(weight), -1, np.int32)
    faces = FaceGraph(GRAPH.edges, weight, FACES.rows)
    (start, target, reverse), capacity, excess = band_network(free, faces, case.place, bounds, local, arc_of)
    assert (local == -1).all()
    assert (arc_of == -1).all()
    found = np.zeros((len(free), len(free)))
    source = np.repeat(np.arange(len(free)), np.diff(start))
    found[source, target] = capacity
    np.testing.assert_array_equal(reverse[reverse], np.arange(len(target)))
    np.testing.assert_array_equal(target[reverse], source)
    expected, beyond = np.zeros_like(found), np.zeros(len(free))
    number = {int(f): i for i, f in enumerate(free)}
    for f, i in number.items():
        for g, e in neighbours(f):
            if g in number:
                expected[i, number[g]] = weight[e]
            elif side[g] >= 0:
                beyond[i] += weight[e] if side[g] == 0 else -weight[e]
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_allclose(excess, beyond, atol=1e-12)
