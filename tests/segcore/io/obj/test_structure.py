"""The groups, objects and materials of the faces of OBJ files."""

import io

from segcore.io import read_mesh
from segcore.mesh import Mesh

VERTICES = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
FACE = "f 1 2 3\n"


def read(lines: str) -> Mesh:
    return read_mesh(io.BytesIO((VERTICES + lines).encode()))


def test_groups_of_one_name_are_one_in_an_object_and_several_in_different_objects() -> None:
    mesh = read(f"{FACE}o car\n{FACE}g wheel\n{FACE}g door\n{FACE}g wheel\n{FACE}o cart\ng wheel\n{FACE}")
    assert mesh.structure.group.tolist() == [-1, 0, 1, 2, 1, 3]
    assert mesh.structure.material is None


def test_materials_are_counted_by_name_and_every_triangle_of_a_polygon_has_its_own() -> None:
    mesh = read(f"usemtl red paint\nf 1 2 3 4\nusemtl blue\n{FACE}g x\n{FACE}usemtl  red paint \n{FACE}")
    assert mesh.structure.material.tolist() == [0, 0, 1, 1, 0]
    assert mesh.structure.group.tolist() == [-1, -1, -1, 0, 0]


def test_marks_without_faces_make_no_structure() -> None:
    assert read(f"{FACE}g unused\nusemtl unused\n").structure is None
    assert read(f"o unused\no used\n{FACE}").structure.group.tolist() == [0]
