"""A body with equal limbs in different poses, for the tests: what a robot with several legs is like."""

import numpy as np
from scipy.spatial.transform import Rotation

from helpers.meshes import refined
from segcore.arrays import IntArray
from segcore.mesh import Mesh
from segcore.shapes import box, joined

_HIPS = np.array([[0.8, 0.0, 0.2], [-0.8, 0.0, 0.3], [0.0, 0.5, 0.1], [0.0, -0.5, 0.0]])
_OVERLAP = 0.02  # of a link of a limb with the one before


def body_with_limbs(seed: int, links: int = 4) -> tuple[Mesh, IntArray]:
    """A box with four limbs, which are chains of boxes of random sizes; each limb is turned at random about its hip.

    Returns
    -------
    The mesh, whose shells run into each other, and (F,) the link of every face: 0 for the body, and
    1 + limb * links + i for link i of a limb.
    """
    rng = np.random.default_rng(seed)
    shells = [refined(box((1.6, 1.0, 1.2)), 3)]
    limb = _limb(rng, links)
    for hip in _HIPS:
        outwards = hip * [1.0, 1.0, 0.0]
        turn = Rotation.align_vectors([outwards], [[0.0, 0.0, 1.0]])[0] * Rotation.from_euler("z", rng.uniform(0, 6))
        pose = Rotation.from_rotvec(rng.normal(0.0, 0.25, 3)) * turn
        shells += [Mesh(pose.apply(shell.vertices) + hip, shell.faces) for shell in limb]
    shape = joined(*shells)
    return shape.mesh, shape.parts


def _limb(rng: np.random.Generator, links: int) -> list[Mesh]:
    """The shells of a limb along z, from the origin."""
    shells, height = [], 0.0
    for _ in range(links):
        width, depth, length = *rng.uniform(0.15, 0.4, 2), rng.uniform(0.3, 0.9)
        shells.append(refined(box((width, depth, length), (0.0, 0.0, height + length / 2)), 2))
        height += length - _OVERLAP
    return shells
