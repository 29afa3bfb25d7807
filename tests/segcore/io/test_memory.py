"""Reading a file takes at most six times its size in memory, with and without its appearance."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import trimesh

from helpers.files.written import written
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh
from segcore.mesh import Mesh

MOST = 6  # times the size of the file
PLAIN = ("off", "stl", "stl_ascii", "ply", "obj", "glb")  # as trimesh calls them
KINDS = (*PLAIN, "ply, text", "obj, dressed", "3mf")


def ball() -> trimesh.Trimesh:
    """81,920 faces, so that the constant costs of reading are small in comparison."""
    return trimesh.creation.icosphere(6)


def whole(mesh: Mesh) -> Hierarchy:
    """A hierarchy of one segment."""
    count = len(mesh.faces)
    return Hierarchy(
        split_node=np.zeros(0, np.int32),
        cut_value=np.zeros(0),
        area=np.ones(1),
        face_count=np.array([count], np.int32),
        face_leaf=np.zeros(count, np.int32),
        automatic_segments=1,
    )


def dressed_obj(mesh: trimesh.Trimesh) -> str:
    """Every corner has a normal and texture coordinates."""
    rows = [f"v {x:.6f} {y:.6f} {z:.6f}\nvt {x:.4f} {y:.4f}\nvn {x:.4f} {y:.4f} {z:.4f}\n" for x, y, z in mesh.vertices]
    faces = ["f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n".format(*face) for face in (mesh.faces + 1).tolist()]
    return "".join([*rows, "g ball\n", *faces])


@pytest.fixture(scope="module")
def files() -> dict[str, bytes]:
    mesh = ball()
    plain = {kind: mesh.export(file_type=kind) for kind in PLAIN}
    plain["ply, text"] = trimesh.exchange.ply.export_ply(mesh, encoding="ascii")
    plain["obj, dressed"] = dressed_obj(mesh)
    own = Mesh(mesh.vertices, mesh.faces)
    plain["3mf"] = written("3mf", own, whole(own))
    return {kind: data.encode() if isinstance(data, str) else data for kind, data in plain.items()}


@pytest.mark.parametrize("appearance", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_reading_takes_at_most_six_times_the_file(
    files: dict[str, bytes], kind: str, appearance: bool, tmp_path: Path
) -> None:
    path = tmp_path / "mesh"
    path.write_bytes(files[kind])
    assert len(read_mesh(path, appearance=appearance).faces) == 81_920  # imports and compiles what is needed
    tracemalloc.start()
    try:
        read_mesh(path, appearance=appearance)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < MOST * len(files[kind])
