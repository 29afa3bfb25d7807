"""An OBJ archive with the materials of the input: each face keeps its own, and files keep their bytes."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

from helpers.hierarchies import hierarchy_of
from segcore.errors import InvalidMesh, InvalidParameters
from segcore.io import WRITERS, Original, read_mesh
from segcore.mesh import Mesh

PICTURE = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108020000009077"
    "53de0000000c49444154789c63f8cfc0000003010100c9fe92ef0000000049454e44ae426082"
)
LIBRARY = b"newmtl red paint\nKd 1 0 0\nnewmtl wood\nmap_Kd textures\\\\bark.png\nnewmtl unused\nmap_Kd missing.png\n"
OBJ = "mtllib mat/my colours.mtl\n" + "".join(f"v {x} {y} 0\n" for x in range(7) for y in range(2))
FACES = [(2 * k + 1, 2 * k + 3, 2 * k + 2) for k in range(6)]
PAINT = ["", "red paint", "wood", "wood", "red paint", "red paint"]  # of each face
LABELS = np.array([0, 0, 0, 1, 1, 0])


@pytest.fixture
def source(tmp_path: Path) -> Path:
    text, current = OBJ, ""
    for face, paint in zip(FACES, PAINT, strict=True):
        text += f"usemtl {paint}\n" if paint != current else ""
        current = paint
        text += "f " + " ".join(map(str, face)) + "\n"
    (tmp_path / "mat" / "textures").mkdir(parents=True)
    (tmp_path / "mat" / "my colours.mtl").write_bytes(LIBRARY)
    (tmp_path / "mat" / "textures" / "bark.png").write_bytes(PICTURE)
    (tmp_path / "a.obj").write_text(text)
    return tmp_path / "a.obj"


def written(source: Path, mesh: Mesh) -> bytes:
    target = io.BytesIO()
    hierarchy = hierarchy_of([0], 1 + LABELS[: len(mesh.faces)], 2)
    WRITERS["objzip"].write(target, mesh, hierarchy, 2, keep=Original(source, neighbours=True), names={1: "tail"})
    return target.getvalue()


def test_every_face_keeps_its_material_within_its_part(source: Path) -> None:
    data = written(source, read_mesh(source))
    text = zipfile.ZipFile(io.BytesIO(data)).read("model.obj").decode()
    part, paint, found = "", "", []
    for line in text.splitlines():
        keyword, _, rest = line.partition(" ")
        if keyword == "o":
            part, paint = rest, ""
        elif keyword == "usemtl":
            paint = rest
        elif keyword == "f":
            found.append((part, paint, tuple(map(int, rest.split()))))
    names = ["segment_0", "tail"]
    expected = [(names[label], paint, face) for label, paint, face in zip(LABELS, PAINT, FACES, strict=True)]
    assert sorted(found) == sorted(expected)
    again = read_mesh(io.BytesIO(data))
    assert again.structure is not None
    assert set(again.structure.material_names) == {"red paint", "wood"}


def test_the_files_of_the_input_are_beside_it_with_the_same_bytes(source: Path) -> None:
    archive = zipfile.ZipFile(io.BytesIO(written(source, read_mesh(source))))
    assert archive.namelist() == ["model.obj", "mat/my colours.mtl", "mat/textures/bark.png"]
    assert archive.read("mat/my colours.mtl") == LIBRARY
    assert archive.read("mat/textures/bark.png") == PICTURE
    assert archive.read("model.obj").splitlines()[1] == b"mtllib mat/my colours.mtl"


def test_another_format_has_no_materials_that_obj_could_keep(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(0)
    path = tmp_path / "ball.glb"
    path.write_bytes(ball.export(file_type="glb"))
    target = io.BytesIO()
    mesh = read_mesh(path)
    hierarchy = hierarchy_of([], np.zeros(len(mesh.faces), dtype=np.int32), 1)
    with pytest.raises(InvalidParameters, match="this is glb: choose GLB with keep=all"):
        WRITERS["objzip"].write(target, mesh, hierarchy, None, keep=Original(path))
    assert target.getvalue() == b""


def test_another_file_is_refused(source: Path) -> None:
    mesh = read_mesh(source)
    with source.open("a") as file:
        file.write("f 1 2 3\n")
    with pytest.raises(InvalidMesh, match="not the file that was segmented"):
        written(source, mesh)


def test_a_path_out_of_the_folder_is_never_written(source: Path) -> None:
    (source.parent / "mat" / "my colours.mtl").write_bytes(b"newmtl wood\nmap_Kd ../../../bark.png\n")
    names = zipfile.ZipFile(io.BytesIO(written(source, read_mesh(source)))).namelist()
    assert all(".." not in name for name in names)
