"""Meshes with an appearance, and the appearance that a file or a mesh has."""

import io

import numpy as np
from hypothesis import strategies as st

from helpers.files.hierarchies import two_strips
from segcore.appearance import Appearance
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh
from segcore.mesh import Mesh

AXES = np.vstack([np.eye(3), -np.eye(3)]).astype(np.float32)


@st.composite
def looks(draw: st.DrawFn) -> tuple[Mesh, Hierarchy]:
    """Two strips with an appearance whose corners may all differ."""
    mesh, hierarchy = two_strips()
    extra = draw(st.lists(st.sampled_from(mesh.faces.ravel().tolist()), max_size=6))
    rows = len(mesh.vertices) + len(extra)
    corners = mesh.faces.copy()
    for i, vertex in enumerate(extra):
        face, corner = draw(st.sampled_from(np.argwhere(mesh.faces == vertex).tolist()))
        corners[face, corner] = len(mesh.vertices) + i
    pick = st.lists(st.integers(0, 5), min_size=rows, max_size=rows)
    sixteenths = st.lists(st.tuples(st.integers(-8, 32), st.integers(-8, 32)), min_size=rows, max_size=rows)
    look = Appearance(
        normals=AXES[draw(pick)],
        uvs=np.array(draw(sixteenths), dtype=np.float32).reshape(-1, 2) / 16,
        colors=np.array(draw(st.lists(st.tuples(*[st.integers(0, 255)] * 4), min_size=rows, max_size=rows)), np.uint8),
        extra_vertex=np.array(extra, dtype=np.int32),
        corners=corners if extra else None,
        face_group=np.array([0, 0, 1, 1], dtype=np.int32),
        group_names=("left <wheel>", "rïght"),
    )
    return Mesh(mesh.vertices, mesh.faces, None, look), hierarchy


def seamed() -> tuple[Mesh, Hierarchy, Appearance]:
    """Two strips of which vertex 0 has another normal and colour coordinate in face 2."""
    mesh, hierarchy = two_strips()
    rng = np.random.default_rng(3)
    rows = len(mesh.vertices) + 1
    corners = mesh.faces.copy()
    corners[2][mesh.faces[2] == mesh.faces[2][0]] = rows - 1
    normals = np.eye(3, dtype=np.float32)[rng.integers(0, 3, rows)]
    look = Appearance(
        normals=normals,
        uvs=rng.integers(0, 16, (rows, 2)).astype(np.float32) / 16,
        colors=rng.integers(0, 256, (rows, 4)).astype(np.uint8),
        extra_vertex=mesh.faces[2][:1],
        corners=corners,
    )
    return Mesh(mesh.vertices, mesh.faces, None, look), hierarchy, look


def read_look(data: bytes) -> Appearance:
    look = read_mesh(io.BytesIO(data), appearance=True).appearance
    assert look is not None
    return look


def at_corners(mesh: Mesh) -> dict[str, list]:
    """Each attribute at each corner of each face."""
    look = mesh.appearance
    assert look is not None
    rows = mesh.faces if look.corners is None else look.corners
    return {name: values[rows].tolist() for name, values in look.row_arrays.items()}
