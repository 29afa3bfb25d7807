"""What stretches an object does not depend on where it is, how it is turned and how large it is."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from integrations.blender.shape import shape_matrix

_STRETCHED = np.diag([1.0, 0.5, 0.25])


@pytest.mark.parametrize("seed", range(5))
def test_a_turned_object_has_the_same_shape(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = Rotation.random(random_state=seed).as_matrix().astype(np.float32)  # as Blender stores it
    scale = rng.uniform(0.1, 10.0)
    sheared = _STRETCHED @ (np.eye(3) + np.triu(rng.uniform(-1, 1, (3, 3)), 1))
    for stretch in (_STRETCHED, sheared):
        expected, found = shape_matrix(stretch), shape_matrix(scale * turn.astype(np.float64) @ stretch)
        assert expected is not None
        assert found is not None
        assert np.allclose(found, expected, atol=2e-4)
    assert shape_matrix(scale * turn.astype(np.float64)) is None
    assert shape_matrix(-scale * turn.astype(np.float64)) is None


def test_lengths_are_stretched_as_in_the_world() -> None:
    rng = np.random.default_rng(0)
    matrix = rng.uniform(-1, 1, (3, 3))
    stretch = shape_matrix(matrix)
    assert stretch is not None
    vectors = rng.uniform(-1, 1, (20, 3))
    ratio = np.linalg.norm(vectors @ stretch.T, axis=1) / np.linalg.norm(vectors @ matrix.T, axis=1)
    assert np.allclose(ratio, ratio[0], rtol=1e-2)


def test_an_object_without_size_has_no_shape_of_its_own() -> None:
    assert shape_matrix(np.zeros((3, 3))) is None
