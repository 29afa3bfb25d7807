"""Results do not depend on the number of threads of BLAS.

BLAS divides inner products of more than 10,000 numbers, and products of large matrices, among its threads, and so adds
in another order. The meshes have more edges than that, and more faces than there are clusters.

LAPACK stays for the eigenvalues of 3 x 3 matrices, which BLAS does not divide.
"""

import io
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from hashlib import sha256
from itertools import product

import numpy as np
import pytest

from segcore import shapes
from segcore.io.result import write_result
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters

DEFAULT = SegmentationParameters()
SOLVERS = {
    "flow": SegmentationParameters(affinity="concavity", clusters=0, max_segments=4),
    "inverse_power": SegmentationParameters(affinity="concavity", solver="inverse_power", max_segments=3),
    "split_bregman": SegmentationParameters(affinity="concavity", solver="split_bregman", max_segments=3),
    "p_laplacian": SegmentationParameters(affinity="concavity", solver="p_laplacian", clusters=0, max_segments=2),
}


def rough(mesh: Mesh, seed: int) -> Mesh:
    """The mesh with noise of a thousandth, so that no two edges are equal."""
    return Mesh(mesh.vertices + np.random.default_rng(seed).normal(scale=1e-3, size=mesh.vertices.shape), mesh.faces)


def meshes() -> Iterator[Mesh]:
    """Ten meshes of 8,600 to 20,500 faces."""
    for neck, rings in product((0.15, 0.6), (90, 100)):
        yield rough(shapes.dumbbell(rings, 48, neck).mesh, rings)
    for arms in range(2, 5):
        yield rough(shapes.burr(5, arms).mesh, arms)
    for gap in (2.1, 2.2, 2.3):
        ball = rough(shapes.dumbbell(40, 48).mesh, 0)
        yield shapes.joined(ball, Mesh(ball.vertices + np.array([gap, 0, 0]), ball.faces)).mesh


def digest(mesh: Mesh, parameters: SegmentationParameters) -> str:
    """The SHA-256 of the ``.cleave`` file of a mesh."""
    target = io.BytesIO()
    write_result(target, mesh, segment(mesh, parameters))
    return sha256(target.getvalue()).hexdigest()


def digests() -> dict[str, str]:
    """The digests of the results of all meshes, and of that of one mesh with each solver."""
    found = {f"mesh {number}": digest(mesh, DEFAULT) for number, mesh in enumerate(meshes())}
    return found | {name: digest(next(meshes()), parameters) for name, parameters in SOLVERS.items()}


def digests_with(threads: int) -> dict[str, str]:
    """The same in a process of its own, with some threads of BLAS."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    environment = os.environ | dict.fromkeys(names, str(threads))
    done = subprocess.run([sys.executable, __file__], env=environment, check=True, capture_output=True, text=True)
    found: dict[str, str] = json.loads(done.stdout)
    return found


@pytest.mark.slow
def test_results_do_not_depend_on_the_number_of_threads() -> None:
    one, two = map(digests_with, (1, 2))
    assert len(one) == 10 + len(SOLVERS)
    assert one == two


if __name__ == "__main__":
    json.dump(digests(), sys.stdout)
