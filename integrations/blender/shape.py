"""The shape of an object in the world, without its place and direction."""

import numpy as np
from numpy.typing import NDArray

_DIGITS = 4  # of scale factors: rotations change the digits after the fifth one of Blender's single precision


def shape_matrix(matrix: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """(3, 3) what stretches an object; None if it is stretched in no direction more than in the others.

    A linear map M is a rotation R after a stretch S = (M^T M)^(1/2), the polar decomposition. The parts of a mesh do
    not depend on R, nor on the size, so that objects which are moved or turned keep their parts.

    Parameters
    ----------
    matrix : (3, 3) the linear map from the mesh to the world.
    """
    squares, axes = np.linalg.eigh(matrix.T @ matrix)
    factors = np.sqrt(np.maximum(squares, 0.0))
    largest = factors.max()
    if largest == 0.0 or np.allclose(factors, largest, rtol=10.0**-_DIGITS):
        return None
    stretch: NDArray[np.float64] = np.round((axes * (factors / largest)) @ axes.T, _DIGITS)
    return stretch
