"""Meshes with faces that have no area, as CAD programs fill T-junctions."""

import numpy as np

from segcore.mesh import Mesh


def with_slivers(mesh: Mesh, at: float, chosen: np.ndarray) -> Mesh:
    """A mesh in which some faces are divided at a point of one edge, with a sliver between them and the next face.

    Coordinates are rounded to single precision, as in an STL file.

    Parameters
    ----------
    at : place of the point between the ends of the edge, 0 to 1.
    chosen : (N, 3) the corners of the divided faces, beginning with the one that is not on the edge.
    """
    divided = {tuple(sorted(face)) for face in chosen.tolist()}
    kept = [face for face in mesh.faces.tolist() if tuple(sorted(face)) not in divided]
    points = (1.0 - at) * mesh.vertices[chosen[:, 1]] + at * mesh.vertices[chosen[:, 2]]
    new = []
    for k, (apex, p, q) in enumerate(chosen.tolist(), start=len(mesh.vertices)):
        new += [[apex, p, k], [apex, k, q], [p, q, k]]
    vertices = np.concatenate([mesh.vertices, points]).astype(np.float32).astype(np.float64)
    return Mesh(vertices, np.array(kept + new, dtype=np.int32))


def creased_faces(mesh: Mesh, edge_faces: np.ndarray, dihedral: np.ndarray) -> np.ndarray:
    """(N, 3) the corners of one face at every concave crease, beginning with the one that is not on the crease.

    No face is at two of them.
    """
    chosen, used = [], set()
    for a, b in edge_faces[dihedral < np.deg2rad(-20.0)].tolist():
        face = a if a not in used else b
        if face in used:
            continue
        used.add(face)
        corners = mesh.faces[face].tolist()
        (apex,) = set(corners) - set(mesh.faces[b if face == a else a].tolist())
        i = corners.index(apex)
        chosen.append([apex, corners[(i + 1) % 3], corners[(i + 2) % 3]])
    return np.array(chosen)
