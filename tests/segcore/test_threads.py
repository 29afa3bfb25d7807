"""The number of threads changes no byte of a result."""

import numpy as np
import pytest
from numba import njit

from segcore import segment, shapes, threads
from segcore.coarsen import grains
from segcore.errors import InvalidParameters
from segcore.mesh import Mesh
from segcore.threads import default_threads, in_blocks, meanwhile, sums_of_blocks, use_threads

SYMMETRIC = shapes.dumbbell(rings=60, around=40).mesh
MESHES = {
    "arms": shapes.burr(4).mesh,
    "symmetric": SYMMETRIC,
    "bodies": shapes.joined(SYMMETRIC, shapes.box(centre=(3.0, 0.0, 0.0)), shapes.icosphere(2)).mesh,
    "open": Mesh(SYMMETRIC.vertices, SYMMETRIC.faces[300:]),
}


def bytes_of(mesh, count):
    hierarchy = segment(mesh, threads=count)
    arrays = hierarchy.split_node, hierarchy.cut_value, hierarchy.area, hierarchy.face_leaf, hierarchy.step
    return [array.tobytes() for array in arrays]


@pytest.fixture
def small_blocks(monkeypatch):
    """Blocks and grains as those of millions of faces."""
    monkeypatch.setattr(threads, "BLOCK", 700)
    monkeypatch.setattr(grains, "MANY", 1000)


@pytest.mark.usefixtures("small_blocks")
@pytest.mark.parametrize("name", MESHES)
def test_results_are_the_same_for_any_number_of_threads(name):
    alone = bytes_of(MESHES[name], 1)
    assert bytes_of(MESHES[name], 2) == alone
    assert bytes_of(MESHES[name], 3) == alone


def test_less_than_one_thread_is_rejected():
    with pytest.raises(InvalidParameters, match="at least 1, not 0"):
        segment(shapes.box(), threads=0)


def test_a_segmentation_in_threads_ends_if_its_progress_raises():
    def stop(stage, _):
        if stage == "coarsen":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        segment(SYMMETRIC, on_progress=stop, threads=2)


def test_small_meshes_get_one_thread_and_large_ones_the_idle_cores(monkeypatch):
    monkeypatch.setattr(threads, "usable_cores", lambda: 8)
    monkeypatch.setattr("os.getloadavg", lambda: (2.6, 0.0, 0.0), raising=False)
    assert default_threads(threads.MANY_FACES - 1) == 1
    assert default_threads(threads.MANY_FACES) == 5
    monkeypatch.setattr("os.getloadavg", lambda: (99.0, 0.0, 0.0), raising=False)
    assert default_threads(threads.MANY_FACES) == 1


@njit
def _square(start, end, values, squares):
    for i in range(start, end):
        squares[i] = values[i] ** 2


@njit
def _sum(start, end, values):
    return np.array([values[start:end].sum()])


@pytest.mark.usefixtures("small_blocks")
@pytest.mark.parametrize("count", [1, 2])
def test_every_item_is_in_one_block(count):
    values = np.arange(2000.0)
    squares = np.zeros(2000)
    with use_threads(count):
        in_blocks(_square, 2000, values, squares)
        assert sums_of_blocks(_sum, 2000, values)[0] == values.sum()
    np.testing.assert_array_equal(squares, values**2)


@pytest.mark.parametrize("count", [1, 2])
def test_a_call_that_was_begun_raises_its_error_if_its_result_is_asked_for(count):
    with use_threads(count):
        number, error = meanwhile(int, "7"), meanwhile(int, "seven")
        assert number() == 7
        with pytest.raises(ValueError, match="seven"):
            error()
