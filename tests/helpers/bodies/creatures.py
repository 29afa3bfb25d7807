"""A body with limbs that is its own mirror image, meshed symmetrically or not, for the tests."""

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.mesh import Mesh
from segcore.shapes import icosphere

_HALF = np.array([[1.0, 0.1, 0.5], [0.55, 0.65, -0.6], [0.55, -0.65, -0.6]])  # an arm and two legs
_LIMBS = np.concatenate([[[0.0, 0.5, 0.85]], _HALF, _HALF * [-1.0, 1.0, 1.0]])
LIMBS = _LIMBS / np.linalg.norm(_LIMBS, axis=1, keepdims=True)  # a head, three limbs with x > 0, and their images


def creature(turn: FloatArray | None = None, subdivisions: int = 4, missing: int = 0) -> Mesh:
    """A ball with a head, two arms and four legs, symmetric in x.

    Parameters
    ----------
    turn : a rotation (3, 3) of the faces over the shape; without one the mesh is symmetric like the shape.
    missing : how many limbs are left out, the last ones.
    """
    sphere = icosphere(subdivisions)
    places = sphere.vertices if turn is None else sphere.vertices @ turn.T
    reach = 1.6 / (1 + np.exp(60 * (0.93 - places @ LIMBS[: len(LIMBS) - missing].T)))
    return Mesh(places * (1 + reach.sum(axis=1, keepdims=True)), sphere.faces)


def limb_of_face(mesh: Mesh) -> IntArray:
    """(F,) 0 for the faces of the ball, 1 + i for those of limb i."""
    centres = mesh.corners.mean(axis=1)
    towards = (centres / np.linalg.norm(centres, axis=1, keepdims=True)) @ LIMBS.T
    limb: IntArray = np.where(towards.max(axis=1) > 0.86, 1 + towards.argmax(axis=1), 0).astype(np.int32)
    return limb


def mirrored_labels(mesh: Mesh, labels: IntArray) -> IntArray:
    """(F,) the label of the face whose centroid is nearest to the image of every face in the plane x = 0."""
    from scipy.spatial import KDTree

    centres = mesh.corners.mean(axis=1)
    mirrored: IntArray = labels[KDTree(centres).query(centres * [-1.0, 1.0, 1.0])[1]]
    return mirrored
