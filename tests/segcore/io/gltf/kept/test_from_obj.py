"""OBJ files with materials and pictures, and files of other formats, as glTF divided by part."""

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.files.kept import Opened, in_any_order
from helpers.files.rich_gltf import RED
from helpers.files.samples import THREEMF_SQUARE
from helpers.hierarchies import hierarchy_of_labels
from segcore import shapes
from segcore.appearance import Appearance
from segcore.io import Original, read_mesh, write_kept, write_mesh
from segcore.io.palette import linear_rgb
from segcore.mesh import Mesh

JPEG = b"\xff\xd8\xff\xe0 as it stands"
OBJ = b"""mtllib a.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 2 0 0
v 2 1 0
vt 0 0
vt 1 0.25
vt 1 1
vn 0 0 2
o first
usemtl paint
f 1/1 2/2 3/3
f 1 3 4
usemtl metal
f 2//1 5//1 6//1 3//1
o second thing
usemtl nowhere
f 1/1/1 3/3/1 6/2/1
f 1/9 3/3 6/2
"""
MTL = b"""newmtl unused
newmtl paint
Kd 0.5 0.5 0.5
d 0.5
map_Kd -s 2 1 red.png
map_Ks shine.png
newmtl metal
Kd 0 0 0
Ke 0.5 0 0
Pm 1
Ns 250
map_Kd photo.jpg
map_Ke photo.jpg
norm pic.tga
"""
FILES = {"x/a.obj": OBJ, "x/a.mtl": MTL, "x/red.png": RED, "x/photo.jpg": JPEG, "x/pic.tga": b"\0\0\2"}


def archive(files: dict[str, bytes]) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w") as packed:
        for name, data in files.items():
            packed.writestr(name, data)
    return target.getvalue()


def kept_with_notes(data: bytes, labels: np.ndarray, **options: Any) -> tuple[Opened, tuple[str, ...]]:
    target = io.BytesIO()
    notes = write_kept(target, Original(io.BytesIO(data), **options), hierarchy_of_labels(labels))
    return Opened(target.getvalue()), notes


@pytest.fixture
def painted() -> tuple[Opened, tuple[str, ...]]:
    return kept_with_notes(archive(FILES), np.array([0, 1, 0, 1, 0, 1]))


def test_every_part_has_its_faces(painted: tuple[Opened, Any]) -> None:
    mesh = read_mesh(io.BytesIO(OBJ))
    labels = np.array([0, 1, 0, 1, 0, 1])
    for part, corners in painted[0].corners_by_part().items():
        assert in_any_order(corners) == in_any_order(mesh.corners[labels == part])


def test_groups_are_nodes_and_materials_those_of_the_faces(painted: tuple[Opened, Any]) -> None:
    document = painted[0].document
    found = {
        (node["name"], document["materials"][entry["material"]]["name"], tuple(sorted(entry["attributes"])))
        for node in document["nodes"]
        if "mesh" in node
        for entry in document["meshes"][node["mesh"]]["primitives"]
    }
    assert found == {
        ("first", "paint", ("POSITION", "TEXCOORD_0")),
        ("first", "paint", ("POSITION",)),
        ("first", "metal", ("NORMAL", "POSITION")),
        ("second thing", "without material", ("NORMAL", "POSITION", "TEXCOORD_0")),
        ("second thing", "without material", ("POSITION",)),
    }


def test_materials_and_pictures_are_converted(painted: tuple[Opened, tuple[str, ...]]) -> None:
    opened, notes = painted
    document = opened.document
    materials = {material["name"]: material for material in document["materials"]}
    assert "unused" not in materials
    paint, metal = materials["paint"], materials["metal"]
    grey = round(float(linear_rgb(np.array([0.5]))[0]), 6)
    assert paint["pbrMetallicRoughness"]["baseColorFactor"] == [grey, grey, grey, 0.5]
    assert paint["alphaMode"] == "BLEND"
    texture = paint["pbrMetallicRoughness"]["baseColorTexture"]
    assert texture["extensions"]["KHR_texture_transform"] == {"offset": [0.0, 0.0], "scale": [2.0, 1.0]}
    assert "KHR_texture_transform" in document["extensionsUsed"]
    assert metal["pbrMetallicRoughness"]["baseColorFactor"] == [1, 1, 1, 1]
    assert metal["pbrMetallicRoughness"]["metallicFactor"] == 1
    assert metal["pbrMetallicRoughness"]["roughnessFactor"] == 0.5
    assert metal["emissiveFactor"] == [grey, 0, 0]
    assert metal["emissiveTexture"]["index"] == metal["pbrMetallicRoughness"]["baseColorTexture"]["index"]
    assert "normalTexture" not in metal
    pictures = [(image["name"], image["mimeType"], opened.picture(i)) for i, image in enumerate(document["images"])]
    assert pictures == [("red", "image/png", RED), ("photo", "image/jpeg", JPEG)]
    assert [note for note in notes if "'pic.tga' is neither PNG nor JPEG" in note]
    assert [note for note in notes if "'nowhere'" in note]
    assert [note for note in notes if "'paint': map_ks" in note]


def test_texture_coordinates_count_from_the_other_side(painted: tuple[Opened, Any]) -> None:
    opened = painted[0]
    (accessor,) = {
        entry["attributes"].get("TEXCOORD_0") for mesh in opened.document["meshes"] for entry in mesh["primitives"]
    } - {None}
    assert [1.0, 0.75] in opened.numbers(accessor).tolist()


def test_a_picture_outside_of_the_set_is_left_out() -> None:
    opened, notes = kept_with_notes(OBJ, np.zeros(6, dtype=int))
    assert "images" not in opened.document
    assert notes == ("No material file of the set has 'paint', 'metal', 'nowhere'.",)


def test_a_folder_is_a_set(tmp_path: Path) -> None:
    for name, data in FILES.items():
        (tmp_path / Path(name).name).write_bytes(data)
    target = io.BytesIO()
    write_kept(target, Original(tmp_path / "a.obj", neighbours=True), hierarchy_of_labels(np.zeros(6, dtype=int)))
    assert [Opened(target.getvalue()).picture(i) for i in range(2)] == [RED, JPEG]


@pytest.mark.parametrize("form", ["ply", "stl", "obj", "off"])
def test_files_of_other_formats_keep_what_they_have(form: str) -> None:
    ball = shapes.icosphere(1)
    normals = (ball.vertices / np.linalg.norm(ball.vertices, axis=1, keepdims=True)).astype(np.float32)
    colors = np.tile(np.array([[255, 0, 128, 255]], dtype=np.uint8), (len(ball.vertices), 1))
    target = io.BytesIO()
    write_mesh(target, Mesh(ball.vertices, ball.faces, appearance=Appearance(normals=normals, colors=colors)), form)
    mesh = read_mesh(io.BytesIO(target.getvalue()), appearance=True)
    labels = np.arange(len(mesh.faces)) % 2
    opened, _ = kept_with_notes(target.getvalue(), labels)
    for part, corners in opened.corners_by_part().items():
        np.testing.assert_allclose(in_any_order(corners), in_any_order(mesh.corners[labels == part]), atol=1e-6)
    attributes = opened.document["meshes"][0]["primitives"][0]["attributes"]
    assert set(attributes) == {"POSITION"} | ({"NORMAL", "COLOR_0"} if form in ("ply", "obj") else set())
    if "COLOR_0" in attributes:
        linear = round(65535 * float(linear_rgb(np.array([128 / 255]))[0]))
        np.testing.assert_allclose(opened.numbers(attributes["COLOR_0"])[0], [65535, 0, linear, 65535], atol=8)


def test_coordinates_far_from_the_origin_keep_their_details() -> None:
    far = b"v 7000000.25 5000000.5 0\nv 7000001.25 5000000.5 0\nv 7000001.25 5000001.125 0\nf 1 2 3\nf 1 3 2\n"
    opened, _ = kept_with_notes(far, np.array([0, 1]))
    found = np.concatenate(list(opened.corners_by_part().values()))
    assert in_any_order(found) == in_any_order(read_mesh(io.BytesIO(far)).corners)


def test_a_3mf_file_is_in_metres_with_y_up() -> None:
    mesh = read_mesh(io.BytesIO(THREEMF_SQUARE))
    opened, _ = kept_with_notes(THREEMF_SQUARE, np.array([0, 1]))
    found = np.concatenate(list(opened.corners_by_part().values()))
    turned = mesh.corners[:, :, [0, 2, 1]] * [0.001, 0.001, -0.001]
    np.testing.assert_allclose(in_any_order(found), in_any_order(turned), atol=1e-9)
