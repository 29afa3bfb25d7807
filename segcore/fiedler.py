"""Eigenvectors of the graph Laplacian: the relaxation of the normalized cut, p = 2."""

import numpy as np
from scipy.sparse import diags_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from segcore.arrays import FloatArray
from segcore.graph import SurfaceGraph


def fiedler_vectors(graph: SurfaceGraph, count: int = 1) -> FloatArray:
    """The generalised eigenvectors L v = lambda D v after the constant one, D = diag(volume), smallest lambda first.

    Parameters
    ----------
    graph : connected, of at least two nodes.

    Returns
    -------
    (N, min(count, N - 1)), each of unit D-norm and with its entry of largest magnitude positive.
    """
    count = min(count, graph.node_count - 1)
    shift = 1e-10 * graph.degrees().max() / graph.volume.max()
    L = diags_array(graph.degrees()) - graph.adjacency()
    D = diags_array(graph.volume)
    if graph.node_count <= 40:
        from scipy.linalg import eigh

        _, vectors = eigh(L.toarray(), np.diag(graph.volume), subset_by_index=[1, count])
    else:
        lu = splu(
            (L + shift * D).tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0, options={"SymmetricMode": True}
        )
        inverse = LinearOperator(L.shape, lu.solve)
        start = np.cos(np.arange(graph.node_count))
        _, vectors = eigsh(L, k=count + 1, M=D, sigma=-shift, OPinv=inverse, v0=start, tol=1e-8)
        vectors = vectors[:, 1:]
    largest = np.abs(vectors).argmax(axis=0)
    return vectors * np.sign(vectors[largest, np.arange(count)])
