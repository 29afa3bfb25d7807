"""Models that are several files: in a ZIP archive, or in a folder."""

import gzip
import io
import os
from pathlib import Path

import pytest

from helpers.files.samples import BINARY_STL, OBJ, OFF, gltf_with_buffer
from helpers.uploads import zip_of
from segcore.errors import InvalidMesh, LimitExceeded, UnsupportedFormat
from segcore.io import ReadLimits, read_mesh


def faces(data: bytes, **options: object) -> int:
    return len(read_mesh(io.BytesIO(data), **options).faces)  # type: ignore[arg-type]


def test_the_one_mesh_of_an_archive_is_read_whatever_is_beside_it() -> None:
    beside = {"m/a.mtl": b"newmtl red\n", "m/tex.png": b"\x89PNG", "readme.txt": b"hello", "m/": b""}
    of_systems = {"__MACOSX/m/._a.obj": b"\0\5", "m/.hidden.obj": b"", "Thumbs.db": b"", "m/desktop.ini": b""}
    for name, data in (("m/a.obj", OBJ), ("M/A.OBJ", OBJ), ("a.off", OFF), ("b.stl", BINARY_STL)):
        assert faces(zip_of({**beside, name: data, **of_systems})) == 2
    assert faces(zip_of({"a.off.gz": gzip.compress(OFF), **beside})) == 2
    assert faces(zip_of({"a.stl": BINARY_STL})) == 2
    assert faces(gzip.compress(zip_of({"a.off": OFF}))) == 2


@pytest.mark.parametrize(
    ("model", "uri", "buffer"),
    [
        ("scene.gltf", "scene.bin", "scene.bin"),
        ("model/scene.gltf", "data/the%20buffer.bin", "model/data/the buffer.bin"),
        ("model/scene.gltf", "../shared/scene.bin", "shared/scene.bin"),
        ("model\\scene.gltf", "data\\Scene.BIN", "model/data/scene.bin"),
        ("scene.gltf", "./größe.bin", "größe.bin"),
    ],
)
def test_buffers_of_gltf_are_found_in_the_archive(model: str, uri: str, buffer: str) -> None:
    text, binary = gltf_with_buffer(uri)
    assert faces(zip_of({model: text, buffer: binary})) == 2


@pytest.mark.parametrize(
    "uri",
    ["missing.bin", "../scene.bin", "/scene.bin", "file:///scene.bin", "https://example.org/scene.bin", "c:/a.bin"],
)
def test_a_buffer_that_is_not_in_the_archive_is_named(uri: str) -> None:
    text, binary = gltf_with_buffer(uri)
    with pytest.raises(UnsupportedFormat, match=r"is another file, .* which is not here: send both in a ZIP archive"):
        faces(zip_of({"scene.gltf": text, "scene.bin": binary}))
    with pytest.raises(UnsupportedFormat, match="is another file"):
        faces(text)


def test_a_buffer_that_is_cut_short_is_damage() -> None:
    text, binary = gltf_with_buffer("scene.bin")
    with pytest.raises(InvalidMesh, match="should have"):
        faces(zip_of({"scene.gltf": text, "scene.bin": binary[:-1]}))


def test_an_archive_without_a_mesh_or_with_several_is_refused_with_their_names() -> None:
    with pytest.raises(UnsupportedFormat, match=r"contains no mesh, but readme\.txt: add the mesh file"):
        faces(zip_of({"readme.txt": b"hello"}))
    with pytest.raises(UnsupportedFormat, match="contains no mesh, but nothing"):
        faces(zip_of({"folder/": b""}))
    with pytest.raises(UnsupportedFormat, match=r"contains 2 meshes \(a\.off, b\.stl\).*as a batch"):
        faces(zip_of({"x/a.off": OFF, "b.stl": BINARY_STL}))
    with pytest.raises(UnsupportedFormat, match="ZIP archive"):  # an archive in an archive is not opened
        faces(zip_of({"a.off": zip_of({"b.off": OFF})}))
    with pytest.raises(UnsupportedFormat, match=r"declared or named as STL, but its content is a ZIP archive"):
        faces(zip_of({"a.stl": BINARY_STL}), format="stl")


def test_limits_hold_for_what_is_in_an_archive() -> None:
    bomb = zip_of({"a.off": OFF + b"#" * 10_000_000})
    assert len(bomb) < 20_000
    with pytest.raises(LimitExceeded, match="max_uncompressed_bytes = 100000"):
        faces(bomb, limits=ReadLimits(max_uncompressed_bytes=100_000))
    text, binary = gltf_with_buffer("scene.bin")
    both = zip_of({"scene.gltf": text, "scene.bin": binary})
    with pytest.raises(LimitExceeded):
        faces(both, limits=ReadLimits(max_uncompressed_bytes=len(text) + len(binary) - 1))
    with pytest.raises(LimitExceeded, match="max_faces"):
        faces(zip_of({"a.off": OFF}), limits=ReadLimits(max_faces=1))


def test_a_damaged_archive_is_an_error() -> None:
    whole = zip_of({"a.off": OFF * 100})
    for data in (b"PK\x03\x04 and more", whole[:-30], whole[:40], whole[:60] + b"\xff" * 20 + whole[80:]):
        with pytest.raises((InvalidMesh, UnsupportedFormat)):
            faces(data)


def test_a_member_without_a_name_is_not_the_mesh() -> None:
    nameless = zip_of({"b.off": OFF}).replace(b"b.off", b"\0.off")  # zipfile ends names at a zero byte
    with pytest.raises(UnsupportedFormat, match="contains no mesh"):
        faces(nameless)
    assert faces(zip_of({"a.off": OFF, "b.stl": b""}).replace(b"b.stl", b"\0.stl")) == 2


def test_files_beside_a_path_are_read_if_asked_for(tmp_path: Path) -> None:
    text, binary = gltf_with_buffer("data/scene.bin")
    folder = tmp_path / "a model"
    (folder / "data").mkdir(parents=True)
    (folder / "scene.gltf").write_bytes(text)
    (folder / "data" / "scene.bin").write_bytes(binary)
    (folder / "texture.png").write_bytes(b"\x89PNG")
    assert len(read_mesh(folder / "scene.gltf", neighbours=True).faces) == 2
    assert len(read_mesh(folder, neighbours=True).faces) == 2
    with pytest.raises(UnsupportedFormat, match="is another file"):
        read_mesh(folder / "scene.gltf")
    (folder / "other.off").write_bytes(OFF)
    with pytest.raises(UnsupportedFormat, match=r"contains 2 meshes \(other\.off, scene\.gltf\): name one"):
        read_mesh(folder, neighbours=True)
    with pytest.raises(UnsupportedFormat, match=r"contains no mesh, but scene\.bin"):
        read_mesh(folder / "data", neighbours=True)


def test_nothing_outside_the_folder_of_a_model_is_opened(tmp_path: Path) -> None:
    secret = tmp_path / "secret.bin"
    folder = tmp_path / "model"
    folder.mkdir()
    os.symlink(secret, folder / "link.bin")
    os.symlink(tmp_path, folder / "above")
    os.symlink("loop.bin", folder / "loop.bin")
    os.mkfifo(folder / "pipe.bin")
    for uri in ("../secret.bin", str(secret), secret.as_uri(), "link.bin", "above/secret.bin", "loop.bin", "pipe.bin"):
        text, binary = gltf_with_buffer(uri)
        secret.write_bytes(binary)
        (folder / "scene.gltf").write_bytes(text)
        with pytest.raises(UnsupportedFormat, match="is another file"):
            read_mesh(folder / "scene.gltf", neighbours=True)
