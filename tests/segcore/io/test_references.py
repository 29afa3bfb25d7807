"""The files that a mesh file refers to."""

import gzip
import json
import time
from pathlib import Path

import pytest

from segcore.io import ReadLimits, neighbours_of, referenced_files

OBJ = b"# mtllib no.mtl\nmtllib parts.mtl\nv 0 0 0\n"
MTL = b"newmtl a\nmap_Kd -s 2 2 1 images\\wood grain.png\nMAP_bump -bm 0.5 bump.jpg\nKd 1 0 0\nnorm missing.png\n"


def folder_of(folder: Path, files: dict[str, bytes]) -> Path:
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
    return folder


def named(model: Path) -> set[str]:
    found = neighbours_of(model)
    assert all(path == (model.parent / name).resolve() for name, path in found.items())
    return set(found)


def test_an_obj_file_refers_to_its_materials_and_their_pictures(tmp_path: Path) -> None:
    files = {
        "a.obj": OBJ,
        "parts.mtl": MTL,
        "images/wood grain.png": b"1",
        "bump.jpg": b"2",
        "no.mtl": b"",
        "x.png": b"",
    }
    folder = folder_of(tmp_path, files)
    assert named(folder / "a.obj") == {"parts.mtl", "images/wood grain.png", "bump.jpg"}


def test_pictures_are_relative_to_the_material_library(tmp_path: Path) -> None:
    folder = folder_of(
        tmp_path, {"a.obj": b"mtllib lib/a.mtl\n", "lib/a.mtl": b"map_Kd t.png", "lib/t.png": b"", "t.png": b""}
    )
    assert named(folder / "a.obj") == {"lib/a.mtl", "lib/t.png"}


def test_several_libraries_and_names_with_blanks_are_found(tmp_path: Path) -> None:
    folder = folder_of(
        tmp_path,
        {
            "a.obj": b"mtllib one.mtl two.mtl\r\nmtllib my parts.mtl",
            "my parts.mtl": b"",
            "two.mtl": b"",
            "one.mtl": b"",
        },
    )
    assert named(folder / "a.obj") == {"my parts.mtl", "one.mtl", "two.mtl"}


def test_a_gltf_file_refers_to_its_buffers_and_images(tmp_path: Path) -> None:
    uris = [
        "the%20buffer.bin",
        "images/gr\u00f6\u00dfe.png",
        "data:;base64,AAAA",
        "https://example.org/a.png",
        "../up.png",
    ]
    text = json.dumps({"buffers": [{"uri": uris[0]}], "images": [{"uri": uri} for uri in uris[1:]]}, indent=1)
    files = {"s/a.gltf": text.encode(), "s/the buffer.bin": b"1", "s/images/größe.png": b"2", "up.png": b"3"}
    folder = folder_of(tmp_path, files)
    assert named(folder / "s/a.gltf") == {"the buffer.bin", "images/größe.png"}


@pytest.mark.parametrize(
    "uri",
    ["../secret.mtl", "/etc/hostname", "link.mtl", "outside/secret.mtl", "a\x00.mtl", "x" * 300, "C:\\a.mtl", "."],
)
def test_nothing_outside_of_the_folder_is_found(tmp_path: Path, uri: str) -> None:
    folder = (
        folder_of(tmp_path, {"secret.mtl": b"map_Kd t.png\n", "m/t.png": b"", "m/a.obj": f"mtllib {uri}\n".encode()})
        / "m"
    )
    (folder / "link.mtl").symlink_to("../secret.mtl")
    (folder / "outside").symlink_to("..")
    assert named(folder / "a.obj") == set()


def test_a_compressed_model_is_searched_up_to_the_limit(tmp_path: Path) -> None:
    text = b"v 0 0 0\n" * 400_000 + b"mtllib parts.mtl\n"
    folder = folder_of(
        tmp_path, {"a.obj.gz": gzip.compress(text), "parts.mtl": b"", "cut.obj.gz": gzip.compress(OBJ)[:-9]}
    )
    assert named(folder / "a.obj.gz") == {"parts.mtl"}
    assert named(folder / "cut.obj.gz") <= {"parts.mtl"}
    limits = ReadLimits(max_uncompressed_bytes=2**20)
    assert referenced_files(folder / "a.obj.gz", "a.obj.gz", lambda name: folder / name, limits) == {}


@pytest.mark.parametrize("at", range(2**20 - 24, 2**20 + 4, 3))
def test_a_reference_is_found_at_the_border_of_two_pieces(tmp_path: Path, at: int) -> None:
    folder = folder_of(tmp_path, {"a.obj": b"#" * at + b"\nmtllib parts.mtl\n", "parts.mtl": b""})
    assert named(folder / "a.obj") == {"parts.mtl"}


def test_other_formats_refer_to_nothing(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, {"a.stl": b"solid\nmtllib parts.mtl\n", "parts.mtl": b""})
    assert named(folder / "a.stl") == set()


def test_a_file_with_very_many_references_is_searched_in_part(tmp_path: Path) -> None:
    lines = "".join(f"mtllib {'x ' * 8}{number}.mtl\n" for number in range(2000))
    folder = folder_of(
        tmp_path, {"a.obj": lines.encode(), "5.mtl": b"map_Kd a.png\n" * 10_000, "a.png": b"", "1500.mtl": b""}
    )
    began_at = time.monotonic()
    assert named(folder / "a.obj") == {"5.mtl", "a.png"}
    assert time.monotonic() - began_at < 10
