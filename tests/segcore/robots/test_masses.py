"""Mass properties against those of trimesh."""

import numpy as np
import pytest
import trimesh

from segcore.robots.masses import Solid, encloses_space, mass_properties


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e4])
def test_mass_properties_are_those_of_trimesh(scale: float) -> None:
    shape = trimesh.creation.annulus(
        0.5, 1.0, 2.0, transform=trimesh.transformations.random_rotation_matrix(np.array([0.1, 0.7, 0.4]))
    )
    shape.apply_translation([3, -4, 5])
    found = mass_properties([Solid(scale * shape.vertices, shape.faces.astype(np.int32))], 700.0)
    assert found is not None
    assert found.volume == pytest.approx(scale**3 * shape.volume)
    assert found.mass == pytest.approx(700 * scale**3 * shape.volume)
    assert found.centre == pytest.approx(scale * shape.center_mass)
    assert found.inertia == pytest.approx(700 * scale**5 * shape.moment_inertia, rel=1e-6, abs=scale**5 * 1e-6)


def test_several_solids_are_added() -> None:
    both = [trimesh.creation.box(bounds=[(x, 0, 0), (x + 1, 1, 1)]) for x in (0, 3)]
    found = mass_properties([Solid(one.vertices, one.faces.astype(np.int32)) for one in both], 1.0)
    assert found is not None
    assert (found.mass, found.centre.tolist()) == (pytest.approx(2), pytest.approx([2, 0.5, 0.5]))
    assert found.inertia == pytest.approx(np.diag([1 / 3, 1 / 3 + 4.5, 1 / 3 + 4.5]), abs=1e-12)


def test_flat_and_inverted_surfaces_have_none() -> None:
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    faces = np.array([[0, 1, 2], [0, 2, 1]], dtype=np.int32)
    ball = trimesh.creation.icosphere(subdivisions=1)
    assert mass_properties([Solid(flat, faces)], 1.0) is None
    assert mass_properties([Solid(np.zeros((3, 3)), faces)], 1.0) is None
    assert mass_properties([Solid(ball.vertices, ball.faces[:, ::-1])], 1.0) is None
    assert mass_properties([], 1.0) is None


def test_space_is_enclosed_if_edges_are_passed_in_both_directions() -> None:
    box = trimesh.creation.box()
    faces = box.faces.astype(np.int32)
    beside = np.where(faces < 2, faces, faces + 8)  # a second box that shares an edge, so that it has four faces
    assert encloses_space(faces)
    assert encloses_space(np.concatenate([faces, beside]))
    assert not encloses_space(faces[1:])
    assert not encloses_space(np.concatenate([faces[:1, ::-1], faces[1:]]))
