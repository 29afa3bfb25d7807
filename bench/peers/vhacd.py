"""V-HACD: approximate convex decomposition of the solid inside a mesh, called through trimesh."""

from __future__ import annotations

import time
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

import numpy as np

from bench.errors import BenchmarkError
from bench.peers import pieces
from bench.peers.method import MethodFailed, Outcome, source_digest
from bench.princeton import surface

if TYPE_CHECKING:
    from segcore.arrays import FloatArray, IntArray, LongArray
    from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True)
class VHacd:
    """At most the given number of convex hulls; every face belongs to the hull nearest to its centre.

    The settings are the defaults, except the number of hulls and one thread. A centre in several hulls belongs to the
    one in which it is deepest. Every segment is made connected, as for k-means.

    References
    ----------
    Mamou, Lengyel, Peters, Volumetric hierarchical approximate convex decomposition, Game Engine Gems 3, 2016.
    """

    key = "vhacd"
    title = "V-HACD"

    @property
    def settings(self) -> str:
        return f"{source_digest(__file__, pieces.__file__, surface.__file__)} {version('vhacdx')}"

    def prepare(self) -> None:
        """Check the installation.

        Raises
        ------
        BenchmarkError
            If the package vhacdx is not installed.
        """
        try:
            version("vhacdx")
        except PackageNotFoundError:
            raise BenchmarkError(
                "V-HACD needs the package vhacdx: pip install vhacdx, or leave vhacd out of --peers."
            ) from None

    def warm_up(self) -> None:
        """Load the packages."""
        import trimesh.decomposition  # noqa: F401
        import vhacdx  # noqa: F401

    def __call__(self, mesh: Mesh, segments: int) -> Outcome:
        import trimesh
        from trimesh.decomposition import convex_decomposition

        start = time.process_time()
        solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        hulls = convex_decomposition(solid, maxConvexHulls=segments, asyncACD=False)
        if not hulls:
            raise MethodFailed("V-HACD found no part.")
        whole = surface.Surface.from_mesh(mesh.vertices, mesh.faces)
        centres = mesh.corners.mean(axis=1)
        distance = [distance_to_hull(centres, hull["vertices"], hull["faces"]) for hull in hulls]
        nearest = np.argmin(np.stack(distance), axis=0)
        labels = pieces.keep_largest_pieces(mesh.vertices, whole, nearest)
        return Outcome(labels, time.process_time() - start)


def distance_to_hull(points: FloatArray, vertices: FloatArray, faces: IntArray | LongArray) -> FloatArray:
    """(N,) largest signed distance of points to the planes of the faces of a convex hull.

    Inside it is negative: minus the depth. Outside it is the distance to the hull if a face is nearest, and less if an
    edge or a vertex is.

    Parameters
    ----------
    points : (N, 3).
    vertices, faces : (V, 3) and (F, 3) of the hull; the orientation of its faces does not matter.
    """
    corners = vertices[faces.astype(np.int64)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1)
    flat = length > 0
    normals, origins = normals[flat] / length[flat, None], corners[flat, 0]
    inward = np.einsum("ij,ij->i", normals, vertices.mean(axis=0) - origins) > 0
    normals[inward] *= -1
    distance: FloatArray = (points @ normals.T - np.einsum("ij,ij->i", normals, origins)).max(axis=1)
    return distance
