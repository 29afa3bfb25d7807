"""The files that are read: a torus in every format, in the forms that readers treat differently."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import numpy as np

from bench.formats.probe import torus

READ = {
    "PLY, binary": "mesh.ply",
    "GLB": "mesh.glb",
    "STL, binary": "mesh.stl",
    "OFF": "mesh.off",
    "OBJ": "mesh.obj",
}
"""Titles and names of files; another stem has another number of faces."""

MORE = {
    "PLY, text": "text/mesh.ply",
    "glTF": "mesh.gltf",
    "STL, text": "text/mesh.stl",
    "OBJ, quads": "quads/mesh.obj",
    "OBJ, textured": "textured/mesh.obj",
    "3MF": "mesh.3mf",
}
"""The same, of forms that are not compared with trimesh."""

LOOKED_AT = ("PLY, binary", "GLB", "OBJ, textured")
"""Those that are read with their appearance, too."""


def write_usual(folder: Path, stem: str, faces: int) -> None:
    """Write the files of ``READ`` with another stem."""
    import trimesh

    mesh = trimesh.Trimesh(*torus(faces), process=False)
    for name in READ.values():
        mesh.export((folder / name).with_stem(stem))


def write_more(folder: Path, stem: str, faces: int) -> None:
    """Write the files of ``MORE``, of which glTF is made from the GLB file of ``write_usual``."""
    import trimesh

    vertices, triangles = torus(faces)
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    paths = {title: (folder / name).with_stem(stem) for title, name in MORE.items()}
    for path in paths.values():
        path.parent.mkdir(exist_ok=True)
    mesh.export(paths["PLY, text"], encoding="ascii")
    mesh.export(paths["STL, text"], file_type="stl_ascii")
    mesh.export(paths["3MF"])
    paths["glTF"].write_bytes(_with_embedded_buffer((folder / "mesh.glb").with_stem(stem).read_bytes()))
    quads = np.stack([triangles[::2, 0], triangles[::2, 1], triangles[::2, 2], triangles[1::2, 2]], axis=1) + 1
    points = _rows("v %.6f %.6f %.6f\n", vertices)
    paths["OBJ, quads"].write_text(points + _rows("f %d %d %d %d\n", quads))
    looks = _rows("vt %.4f %.4f\n", vertices[:, :2]) + _rows("vn %.4f %.4f %.4f\n", mesh.vertex_normals)
    corners = np.repeat(triangles + 1, 3, axis=1)
    half = len(corners) // 2
    groups = [
        f"g part_{k}\n" + _rows("f %d/%d/%d %d/%d/%d %d/%d/%d\n", part)
        for k, part in enumerate((corners[:half], corners[half:]))
    ]
    paths["OBJ, textured"].write_text(points + looks + "".join(groups))


def _rows(form: str, rows: np.ndarray) -> str:
    return (form * len(rows)) % tuple(rows.ravel().tolist())


def _with_embedded_buffer(glb: bytes) -> bytes:
    """The glTF file of a GLB file."""
    length = int.from_bytes(glb[12:16], "little")
    document = json.loads(glb[20 : 20 + length])
    data = glb[28 + length :][: document["buffers"][0]["byteLength"]]
    document["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{base64.b64encode(data).decode()}"
    return json.dumps(document).encode()
