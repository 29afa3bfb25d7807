"""Laws: a shape gets the same parts in any position and with any meshing."""

from functools import cache

import fast_simplification
import numpy as np
import pytest

from helpers.meshes import agreement, areas, refined, rotation
from segcore import shapes
from segcore.mesh import Mesh
from segcore.method import segment

SHAPES = {
    "burr": shapes.burr(4),
    "burr with three arms": shapes.burr(4, arms=3),
    "dumbbell": shapes.dumbbell(rings=60, around=32),
}
anyshape = pytest.mark.parametrize("name", SHAPES)
SEED = 7


@cache
def labels_of(name):
    """The labels of a shape on its own mesh, with as many segments as it has parts."""
    shape = SHAPES[name]
    return segment(shape.mesh).labels(int(shape.parts.max()) + 1)


def labels_in(mesh, name):
    """The labels of another mesh of a shape, with as many segments as the shape has parts."""
    return segment(mesh).labels(int(SHAPES[name].parts.max()) + 1)


def same(name, labels, weights=None):
    """The agreement by area of labels of the faces of a shape with those of its own mesh."""
    return agreement(labels, labels_of(name), areas(SHAPES[name].mesh) if weights is None else weights)


@anyshape
def test_rigid_motion(name):
    rng = np.random.default_rng(SEED)
    mesh = SHAPES[name].mesh
    moved = Mesh(mesh.vertices @ rotation(rng) + rng.normal(size=3), mesh.faces)
    assert same(name, labels_in(moved, name)) > 0.98


@anyshape
def test_reflection(name):
    mesh = SHAPES[name].mesh
    assert same(name, labels_in(Mesh(mesh.vertices * [-1, 1, 1], mesh.faces), name)) > 0.97


@anyshape
@pytest.mark.parametrize("scale", [1e-6, 3.0, 1e6])
def test_scale(name, scale):
    mesh = SHAPES[name].mesh
    assert same(name, labels_in(Mesh(scale * mesh.vertices, mesh.faces), name)) > 0.98


@anyshape
def test_permutation_of_the_faces(name):
    mesh = SHAPES[name].mesh
    order = np.random.default_rng(SEED).permutation(len(mesh.faces))
    labels = labels_in(Mesh(mesh.vertices, mesh.faces[order]), name)
    assert same(name, labels[np.argsort(order)]) > 0.96


@anyshape
def test_permutation_of_the_vertices(name):
    mesh = SHAPES[name].mesh
    order = np.random.default_rng(SEED).permutation(len(mesh.vertices))
    labels = labels_in(Mesh(mesh.vertices[order], np.argsort(order)[mesh.faces]), name)
    assert same(name, labels) > 0.98


@anyshape
@pytest.mark.parametrize("share", [0.5, 1.0])
def test_flipped_orientation(name, share):
    mesh = SHAPES[name].mesh
    flipped = np.random.default_rng(SEED).random(len(mesh.faces)) < share
    faces = np.where(flipped[:, None], mesh.faces[:, ::-1], mesh.faces)
    assert same(name, labels_in(Mesh(mesh.vertices, faces), name)) > 0.96


@anyshape
def test_duplicated_faces(name):
    mesh = SHAPES[name].mesh
    again = np.random.default_rng(SEED).choice(len(mesh.faces), len(mesh.faces) // 3)
    labels = labels_in(Mesh(mesh.vertices, np.concatenate([mesh.faces, mesh.faces[again, ::-1]])), name)
    assert same(name, labels[: len(mesh.faces)]) > 0.98
    np.testing.assert_array_equal(labels[len(mesh.faces) :], labels[again])


@anyshape
def test_faces_that_are_points(name):
    """Triangles whose corners nearly coincide, as after a simplification, are no parts and do not hide any."""
    mesh = SHAPES[name].mesh
    faces, vertices = mesh.faces, mesh.vertices
    for f in range(0, len(faces), len(faces) // 5):
        a, b, c = faces[f]
        middle = vertices[[a, b, c]].mean(axis=0)
        p, q, r = len(vertices) + np.arange(3)
        vertices = np.concatenate([vertices, middle + 1e-12 * np.eye(3)])
        ring = [(a, b, p), (b, q, p), (b, c, q), (c, r, q), (c, a, r), (a, p, r), (p, q, r)]
        faces = np.concatenate([faces[:f], [ring[0]], faces[f + 1 :], ring[1:]]).astype(np.int32)
    labels = labels_in(Mesh(vertices, faces), name)[: len(mesh.faces)]
    assert same(name, labels) > 0.98


@anyshape
def test_subdivision_without_change_of_shape(name):
    mesh = refined(SHAPES[name].mesh, 1)
    labels = labels_in(mesh, name)
    assert agreement(labels, np.repeat(labels_of(name), 4), areas(mesh)) > 0.95


@anyshape
def test_subdivision_of_one_half(name):
    mesh = SHAPES[name].mesh
    other = half_refined(mesh)
    labels = labels_in(other.mesh, name)
    assert agreement(labels, labels_of(name)[other.parts], areas(other.mesh)) > 0.95


def half_refined(mesh):
    """The mesh with every face of its upper half cut at the centre; part i of the shape is face i of the mesh."""
    upper = mesh.corners[:, :, 2].mean(axis=1) > 0
    centre = len(mesh.vertices) + np.arange(upper.sum())
    a, b, c = mesh.faces[upper].T
    thirds = [np.stack(corners, axis=1) for corners in ((a, b, centre), (b, c, centre), (c, a, centre))]
    vertices = np.concatenate([mesh.vertices, mesh.corners[upper].mean(axis=1)])
    origin = np.flatnonzero(upper)
    faces = np.concatenate([mesh.faces[~upper], *thirds])
    return shapes.Shape(Mesh(vertices, faces), np.concatenate([np.flatnonzero(~upper), origin, origin, origin]))


@anyshape
def test_noise_of_a_hundredth_of_an_edge(name):
    mesh = SHAPES[name].mesh
    edge = np.linalg.norm(mesh.corners[:, 0] - mesh.corners[:, 1], axis=1).mean()
    noise = np.random.default_rng(SEED).normal(scale=0.01 * edge, size=mesh.vertices.shape)
    assert same(name, labels_in(Mesh(mesh.vertices + noise, mesh.faces), name)) > 0.95


@anyshape
def test_half_of_the_faces_decimated(name):
    mesh = SHAPES[name].mesh
    vertices, faces = fast_simplification.simplify(mesh.vertices, mesh.faces, target_reduction=0.5)
    decimated = Mesh(vertices, faces)
    labels = labels_in(decimated, name)
    centres = decimated.corners.mean(axis=1)
    nearest = np.linalg.norm(mesh.corners.mean(axis=1)[:, None] - centres[None], axis=2).argmin(axis=1)
    assert same(name, labels[nearest]) > 0.93
