"""MTL files and the pictures that they name."""

from pathlib import Path

import pytest

from segcore.io import ReadLimits
from segcore.io.file_sets import Companions, FolderCompanions, NoCompanions
from segcore.io.obj.materials import TextureMap, parse_mtl, read_obj_materials, read_picture

MTL = b"""# colours
newmtl old paint
Kd 0.5 0.25 0.125
Ke 0.1
d 0.75
Ns 250
Pr 0.3
Pm 1
map_Kd -s 2 3 -o 0.5 0.25 0 -clamp on my picture.png
norm -bm 0.7 n.png
map_Bump bump.png
Kd nonsense
\tillum 2
newmtl glass
Tr 0.4
Kd 1 inf 0
"""


def folder(tmp_path: Path, **files: bytes) -> Companions:
    for name, data in files.items():
        (tmp_path / name.replace("__", "/")).parent.mkdir(exist_ok=True)
        (tmp_path / name.replace("__", "/")).write_bytes(data)
    return FolderCompanions(tmp_path / "model.obj", ReadLimits())


def test_a_material_has_what_its_lines_say() -> None:
    paint, glass = parse_mtl(MTL, "a.mtl")
    assert (paint.name, paint.library) == ("old paint", "a.mtl")
    assert (paint.diffuse, paint.emissive, paint.opacity) == ((0.5, 0.25, 0.125), (0.1, 0.1, 0.1), 0.75)
    assert (paint.shininess, paint.roughness, paint.metallic) == (250, 0.3, 1)
    assert paint.maps == {
        "map_kd": TextureMap("my picture.png", (0.5, 0.25), (2, 3), is_clamped=True),
        "norm": TextureMap("n.png"),
        "map_bump": TextureMap("bump.png"),
    }
    assert glass.opacity == pytest.approx(0.6)
    assert (glass.diffuse, glass.maps) == ((1, 1, 1), {})


@pytest.mark.parametrize("text", [b"", b"Kd 1 1 1\n", b"newmtl\nmap_Kd\nmap_Kd -s 1 1\nd\n", b"\xff\xfe\0newmtl a\0"])
def test_lines_that_are_not_understood_are_ignored(text: bytes) -> None:
    for material in parse_mtl(text, "a.mtl"):
        assert material.maps.keys() <= {"map_kd"}
        assert material.diffuse is None


@pytest.mark.parametrize(
    ("line", "names"),
    [
        ("mtllib one.mtl", ["a"]),
        ("mtllib one.mtl two.mtl", ["a", "b"]),
        ("mtllib one of two.mtl", ["c"]),
        ("mtllib two.mtl\nmtllib missing.mtl\n  mtllib one.mtl", ["b", "a"]),
        ("# mtllib one.mtl", []),
    ],
)
def test_materials_come_from_the_files_that_are_named(tmp_path: Path, line: str, names: list[str]) -> None:
    files = {"one.mtl": b"newmtl a\n", "two.mtl": b"newmtl b\nnewmtl a\n", "one of two.mtl": b"newmtl c\n"}
    found = read_obj_materials(f"v 0 0 0\n{line}\nusemtl a\n".encode(), folder(tmp_path, **files))
    assert [name for name in names if name in found] == names
    assert read_obj_materials(line.encode(), NoCompanions()) == {}


@pytest.mark.parametrize(
    "path", ["pic.png", "C:\\Users\\me\\pic.png", "/home/me/pic.png", "..\\..\\pic.png", "100%25.png"]
)
def test_pictures_are_found_beside_the_library_and_never_outside_of_the_set(tmp_path: Path, path: str) -> None:
    inside = tmp_path / "set"
    inside.mkdir()
    (tmp_path / "pic.png").write_bytes(b"outside")
    companions = folder(inside, **{"m__a.mtl": b"", "m__pic.png": b"inside", "100%25.png": b"percent"})
    (material,) = parse_mtl(f"newmtl a\nmap_Kd {path}\n".encode(), "m/a.mtl")
    expected = b"percent" if "%" in path else b"inside"
    assert read_picture(companions, material, material.maps["map_kd"]) == expected
    assert read_picture(companions, material, TextureMap("no.png")) is None


def test_an_empty_library_counts_as_missing(tmp_path: Path) -> None:
    assert read_obj_materials(b"mtllib a.mtl", folder(tmp_path, **{"a.mtl": b""})) == {}
