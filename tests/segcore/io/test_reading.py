"""read_mesh for every format: the content decides, limits hold, and the result is a mesh or a typed error."""

import gzip
import io
import struct
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.compressed_gltf import draco_asset, meshopt_asset
from helpers.files.gltf import FLOAT, Asset
from helpers.files.polygon_soups import read, read_or_none
from helpers.files.samples import ASCII_STL, BINARY_STL, DRESSED, OBJ, OFF, PLY, SAMPLES, SQUARE, gltf_square
from helpers.files.threemf import RELATIONSHIPS, Model3MF, package
from segcore.errors import CleaveError, InvalidMesh, InvalidParameters, LimitExceeded, UnsupportedFormat
from segcore.io import FORMATS, ReadLimits, read_mesh
from segcore.io.formats import declared_format

ALL = [(name, data) for name, samples in SAMPLES.items() for data in samples]
"""Each holds two faces."""


@pytest.mark.parametrize(("name", "data"), ALL)
def test_the_format_is_detected_by_the_content_alone(name: str, data: bytes) -> None:
    assert len(read(data).faces) == 2
    assert len(read(data, name).faces) == 2


@pytest.mark.parametrize(("name", "data"), ALL)
@pytest.mark.parametrize("declared", FORMATS)
def test_a_declared_format_that_contradicts_the_content_is_refused_with_both_named(
    name: str, data: bytes, declared: str, tmp_path: Path
) -> None:
    path = tmp_path / f"mesh{FORMATS[declared].extensions[0].upper()}"
    path.write_bytes(data)
    if declared == name:
        assert len(read_mesh(path).faces) == 2
        return
    for source, form in ((io.BytesIO(data), declared), (path, None)):
        with pytest.raises(UnsupportedFormat) as refusal:
            read_mesh(source, form)
        assert FORMATS[name].title in str(refusal.value)
        assert FORMATS[declared].title in str(refusal.value)


def test_an_argument_has_priority_over_an_extension_and_an_unknown_extension_is_ignored(tmp_path: Path) -> None:
    for name, form in (("mesh.stl", "off"), ("mesh.dat", None), ("mesh", None)):
        path = tmp_path / name
        path.write_bytes(OFF)
        assert len(read_mesh(path, form).faces) == 2
        assert len(read_mesh(str(path), form).faces) == 2


@pytest.mark.parametrize("name", FORMATS)
def test_a_format_goes_by_its_name_extensions_and_media_types(name: str) -> None:
    form = FORMATS[name]
    for declaration in (
        name,
        name.upper(),
        *form.extensions,
        *form.media_types,
        f"{form.media_types[0]}; charset=utf-8",
    ):
        assert declared_format(io.BytesIO(), declaration) == name
    for extension in form.extensions:
        assert declared_format(f"folder.x/a{extension}", None) == name
        assert declared_format(Path(f"a{extension}.GZ"), None) == name


def test_an_unknown_declaration_is_refused_with_the_formats_that_are_read() -> None:
    with pytest.raises(UnsupportedFormat, match=r"'dae'.*OFF, STL, PLY, OBJ, GLB, glTF or 3MF"):
        read(OFF, "dae")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"Kaydara FBX Binary  \0", "FBX"),
        (b"<?xml version='1.0'?><COLLADA/>", "XML"),
        (b"\xff\xfe\0O\0F\0F", "UTF-16"),
        (gzip.compress(gzip.compress(OFF, mtime=0), mtime=0), "compressed twice"),
        (b"just some words", "no known mesh format"),
        (bytes(1000), "no known mesh format"),
    ],
)
def test_other_content_is_refused_with_its_name_if_it_is_known(data: bytes, message: str) -> None:
    with pytest.raises(UnsupportedFormat, match=message):
        read(data)


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("data", [OFF, ASCII_STL, PLY["ascii"], OBJ, gltf_square().gltf(), "# größe\n".encode() + OBJ])
def test_texts_in_utf_16_are_read(data: bytes, encoding: str) -> None:
    text = f"\ufeff{data.decode()}".encode(encoding)
    assert len(read(text).faces) == 2
    with pytest.raises(InvalidMesh, match="UTF-16 that is damaged"):
        read(text + b"\n")


@pytest.mark.parametrize("declared", [None, *FORMATS])
@pytest.mark.parametrize(
    ("data", "what"),
    [
        (b"<!DOCTYPE html><html><body>Login</body></html>" + b" " * 200, "a page of HTML"),
        (b"\xef\xbb\xbf\r\n <!-- v 1 2 3 -->\n<HTML lang='en'>", "a page of HTML"),
        (b"<?xml version='1.0'?>\n<!DOCTYPE html PUBLIC '-//W3C'><html>", "a page of HTML"),
        (b"<head><title>404</title></head>", "a page of HTML"),
        (
            b"<?xml version='1.0' encoding='UTF-8'?>\n<Error><Code>AccessDenied</Code></Error>",
            "an XML document <Error>",
        ),
        (b"<svg xmlns='http://www.w3.org/2000/svg'/>", "an XML document <svg>"),
        (b'{"error": "not found", "status": 404}', "a JSON document"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n", "a pointer of Git LFS"),
    ],
)
def test_the_answer_of_a_server_that_was_saved_as_a_mesh_is_named(data: bytes, what: str, declared: str | None) -> None:
    with pytest.raises(UnsupportedFormat, match=f"^The file is {what}, not a mesh: download the mesh itself"):
        read(data, declared)


@pytest.mark.parametrize(("name", "data"), ALL)
def test_files_compressed_with_gzip_are_read(name: str, data: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"mesh{FORMATS[name].extensions[0]}.gz"
    half = len(data) // 2
    path.write_bytes(gzip.compress(data[:half]) + gzip.compress(data[half:]) + bytes(100))
    assert read_mesh(path).faces.tolist() == read(data).faces.tolist()


def test_compressed_files_of_any_size_and_ratio_are_read_whole() -> None:
    noise = "".join(f"0 0 {value}\n" for value in np.random.default_rng(0).random(60_000).tolist()).encode()
    for body in (noise, b"0 0 0\n" * 600_000):
        count = body.count(b"\n")
        data = b"OFF\n%d 1 0\n%s3 0 1 2\n" % (count, body)
        assert len(read(gzip.compress(data, 1)).vertices) == count


def test_a_damaged_or_cut_compression_is_refused() -> None:
    data = gzip.compress(OFF)
    for length in range(2, len(data)):
        with pytest.raises(InvalidMesh, match=r"cut short|damaged"):
            read(data[:length])
    with pytest.raises(InvalidMesh, match="damaged"):
        read(data[:-8] + b"\0" + data[-7:])
    with pytest.raises(InvalidMesh, match="something else"):
        read(data + b"tail")


def test_bytes_beyond_the_limits_are_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "mesh.off"
    path.write_bytes(OFF)
    small = ReadLimits(max_bytes=len(OFF) - 1)
    for source in (path, io.BytesIO(OFF)):
        assert len(read_mesh(source, limits=ReadLimits(max_bytes=len(OFF))).faces) == 2
        with pytest.raises(LimitExceeded, match=f"max_bytes = {len(OFF) - 1}"):
            read_mesh(path, limits=small)
    bomb = gzip.compress(bytes(10**7))
    with pytest.raises(LimitExceeded, match="max_uncompressed_bytes = 1000000"):
        read(bomb, limits=ReadLimits(max_uncompressed_bytes=10**6))


@pytest.mark.parametrize("value", [0, -1, 1.5, True, "9"])
def test_limits_must_be_positive_integers(value: object) -> None:
    with pytest.raises(InvalidParameters, match="max_faces"):
        ReadLimits(max_faces=value)  # type: ignore[arg-type]


def test_a_missing_file_or_a_folder_is_an_error_of_the_system(tmp_path: Path) -> None:
    for path, error in ((tmp_path / "missing.off", FileNotFoundError), (tmp_path, IsADirectoryError)):
        with pytest.raises(error):
            read_mesh(path)


@pytest.mark.parametrize("form", [None, *FORMATS])
def test_an_empty_file_is_refused(form: str | None) -> None:
    for data in (b"", gzip.compress(b"")):
        with pytest.raises(InvalidMesh, match="empty"):
            read(data, form)


beginnings = st.sampled_from(
    [
        b"", b"OFF\n", b"COFF 3 1 0\n", b"solid x\nfacet normal 0 0 1\n", b"ply\nformat ascii 1.0\n", b"glTF\2\0\0\0",
        b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nend_header\n",
        b"v 0 0 0\nf 1 1 1\n", b'{"asset": {"version": "2.0"}, ', b"\x1f\x8b\x08", *(data for _, data in ALL),
    ]
)  # fmt: skip


@given(beginnings, st.binary(max_size=200), st.sampled_from([None, *FORMATS]))
def test_any_bytes_give_a_mesh_or_a_typed_error(beginning: bytes, rest: bytes, form: str | None) -> None:
    read_or_none(beginning + rest, form)


def hostile_files() -> list[bytes]:
    """Small files that announce or refer to far more data than they have."""
    vertices = "property float x\nproperty float y\nproperty float z\n"
    faces = "property list int int vertex_indices\nend_header\n"
    files = [
        f"OFF\n{v} {f} 0\n0 0 0\n3 0 0 0\n".encode() for v, f in ((1, 19_999_999), (59_999_999, 1), (4 * 10**9, 1))
    ]
    for encoding in ("ascii", "binary_little_endian"):
        for v, f in ((1, 19_999_999), (59_999_999, 1), (4 * 10**9, 4 * 10**9)):
            header = f"ply\nformat {encoding} 1.0\nelement vertex {v}\n{vertices}element face {f}\n{faces}"
            files.append(header.encode() + b"\x7f" * 32)
        header = f"ply\nformat {encoding} 1.0\nelement vertex 1\n{vertices}element face 1\n{faces}"
        files.append(header.encode() + (b"0 0 0\n1999999999 0" if encoding == "ascii" else b"\0" * 12 + b"\x7f" * 8))
    files.append(b"ply\nformat ascii 1.0\nelement vertex 19999999\nelement face 19999999\nend_header\n")
    files.append(bytes(80) + struct.pack("<I", 19_999_999) + bytes(100))
    files.append(b"v 0 0 0\nf 1 1 -2147483648\nf 1 1 99999999999999999999\n")
    for count in (19_999_998, 2_000_000_001):
        for key in ("bufferView", "count"):
            asset = Asset()
            asset.add("meshes", {"primitives": [asset.primitive(asset.accessor([(0.0, 0.0, 0.0)] * 3, FLOAT))]})
            asset.root(mesh=0)
            asset.document["accessors"][0]["count"] = count
            if key == "bufferView":
                del asset.document["accessors"][0]["bufferView"]
            files.append(asset.glb())
    files.append(gzip.compress(bytes(250_000)))
    return files


def test_a_small_file_never_makes_the_process_take_much_memory(tmp_path: Path) -> None:
    """Each file is read with an address space of 200 MB beyond that of the imported program."""
    paths = [tmp_path / f"{i}.bin" for i in range(len(hostile_files()))]
    for path, data in zip(paths, hostile_files(), strict=True):
        assert len(data) < 700
        path.write_bytes(data)
    script = """
import resource, sys
import segcore
from segcore.errors import CleaveError
from segcore.io import read_mesh

segcore.warm_up("read")  # readers and kernels are imported when they are used
pages = int(open("/proc/self/statm").read().split()[0])
room = pages * resource.getpagesize() + 200 * 10**6
resource.setrlimit(resource.RLIMIT_AS, (room, room))
for path in sys.argv[1:]:
    for appearance in (False, True):
        try:
            read_mesh(path, appearance=appearance)
            print(path, "was read")
        except CleaveError:
            pass
"""
    if not Path("/proc/self/statm").exists():
        pytest.skip("the size of a process is found in /proc")
    run = subprocess.run([sys.executable, "-c", script, *map(str, paths)], capture_output=True, text=True, check=False)
    assert (run.stdout, run.stderr) == ("", "")


def outward_files() -> dict[str, bytes]:
    """Files with references to other files and addresses, in each way that a careless reader would follow."""
    files = {"a.obj": b"mtllib /etc/passwd\nmtllib ../secret.mtl\nmap_Kd http://localhost/a.png\ncall x.obj\n" + OBJ}
    for i, uri in enumerate(("/etc/passwd", "../secret.bin", "file:///etc/passwd", "http://localhost:9/a.bin")):
        text = gltf_square().gltf().decode()
        begin = text.index('"uri": "') + 8
        files[f"{i}.gltf"] = (text[:begin] + uri + text[text.index('"', begin) :]).encode()
    asset = gltf_square()
    asset.document["images"] = [{"uri": "/etc/passwd"}]
    files["a.glb"] = asset.glb()
    files["a.ply"] = PLY["ascii"].replace(b"comment ", b"comment TextureFile /etc/passwd\ncomment ")
    files["a.3mf"] = threemf_that_looks_outside()
    entity = '<!DOCTYPE model [<!ENTITY a SYSTEM "file:///etc/passwd">]><model'
    files["b.3mf"] = package({"3D/3dmodel.model": Model3MF().xml().replace("<model", entity, 1)})
    for name, (data, *_) in DRESSED.items():  # with names and attributes, which not all readers use
        files[f"dressed.{name}"] = data
    files["meshopt.glb"] = meshopt_asset().glb()
    if find_spec("DracoPy"):
        files["draco.glb"] = draco_asset()[0].glb()
    files["a.off"], files["a.stl"], files["b.stl"] = OFF, ASCII_STL, BINARY_STL
    files["a.off.gz"] = gzip.compress(OFF)
    return files


def threemf_that_looks_outside() -> bytes:
    model = Model3MF()
    model.item(model.mesh(SQUARE))
    model.item(model.add('<components><component p:path="/../../../etc/passwd" objectid="1"/></components>'))
    outside = RELATIONSHIPS.format(target="http://localhost:9/a.model").replace("Id=", 'TargetMode="External" Id=')
    return model.package(**{"3D/_rels/3dmodel.model.rels": outside})


def test_no_reader_opens_a_file_or_a_socket_that_it_was_not_given(tmp_path: Path) -> None:
    paths = []
    for name, data in outward_files().items():
        (tmp_path / name).write_bytes(data)
        paths.append(str(tmp_path / name))
    script = """
import io, sys
from segcore.errors import CleaveError
from segcore.io import read_mesh

def read(source):
    for appearance in (False, True):
        try:
            read_mesh(source, appearance=appearance)
        except CleaveError:
            pass
        if hasattr(source, "seek"):
            source.seek(0)

contents = [open(path, "rb").read() for path in sys.argv[1:]]
for content in contents:  # imports what is imported late
    read(io.BytesIO(content))
given, events = [], []

def hook(event, arguments):
    if event == "open" and arguments[0] in given:
        return
    if event == "open" or event.split(".")[0] in ("socket", "subprocess", "os", "shutil", "urllib", "http", "ctypes"):
        events.append((event, arguments))

sys.addaudithook(hook)
for path, content in zip(sys.argv[1:], contents, strict=True):
    read(io.BytesIO(content))
    given[:] = [path]
    read(path)
    given.clear()
sys.stdout.write(repr(events))
"""
    run = subprocess.run([sys.executable, "-c", script, *paths], capture_output=True, text=True, check=False)
    assert (run.stdout, run.stderr) == ("[]", "")


def test_errors_are_one_short_sentence_for_any_content() -> None:
    """The messages are sent to clients unchanged."""
    long = b"x" * 10**6
    hostile = [
        OFF.replace(b"1 1 0", b"1 " + long + b" 0"),
        OBJ.replace(b"f 1 2 3", b"f 1 2 " + long),
        PLY["ascii"].replace(b"property float x", b"property " + long + b" x"),
        PLY["ascii"].replace(b"format ascii", b"format " + long),
        PLY["ascii"].replace(b"element face 2", b"element " + long + b" 99999999"),
        ASCII_STL.replace(b"vertex 1 0 0", b"vertex 1 " + long + b" 0"),
        gltf_square().gltf().replace(b'"2.0"', b'"1.' + long + b'"'),
        gltf_square().gltf().replace(b'"mesh": 0', b'"mesh": ' + b"9" * 4000),
        gltf_square().gltf().replace(b'"count": 4', b'"count": ' + b"9" * 5000),
        gltf_square().gltf().replace(b'"asset"', b'"extensionsRequired": ["' + long + b'"], "asset"'),
    ]
    for data in hostile:
        with pytest.raises(CleaveError) as refusal:
            read(data)
        assert len(str(refusal.value)) < 300
        assert str(refusal.value).isprintable()
        assert str(refusal.value).endswith(".")


def test_arrays_are_writable_contiguous_and_of_the_promised_types() -> None:
    for _, data in ALL:
        mesh = read(data)
        for array, dtype in ((mesh.vertices, np.float64), (mesh.faces, np.int32)):
            assert array.dtype == dtype
            assert array.flags.c_contiguous
            assert array.flags.writeable
