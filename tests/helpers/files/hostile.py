"""Files of an attacker, each with the error codes that its job may end with."""

import gzip
import io
import json
import struct
import zipfile
from collections.abc import Iterator

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_RELATIONSHIPS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="a" '
    'Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
_TETRAHEDRON = (
    '<object id="1" type="model"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>'
    '<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/>'
    '<triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles>'
    "</mesh></object>"
)
_BOMB_BYTES = 400 * 2**20
_REFUSED = {"invalid_mesh", "unsupported_format", "limit_exceeded"}
_ANYTHING = _REFUSED | {None}  # harmless if read


def hostile_files(target_url: str, secret: str) -> Iterator[tuple[str, bytes, set[str | None]]]:
    """Yield names, contents and the codes that the jobs may end with, None for success.

    Parameters
    ----------
    target_url : the URL in files that try to make the server connect to it.
    secret : the path in files that try to read another file.
    """
    yield from _bombs()
    yield from _liars()
    yield from _crowds()
    yield from _readers(target_url, secret)
    yield from _chameleons()


def _bombs() -> Iterator[tuple[str, bytes, set[str | None]]]:
    """Small files that unpack to much data."""
    yield "bomb.off.gz", _deflated(_BOMB_BYTES), _REFUSED
    yield "bomb.3mf", _package(_spaces()), _ANYTHING
    laughs = "".join(f'<!ENTITY l{n} "{f"&l{n - 1};" * 10}">' for n in range(1, 12))
    doctype = f'<!DOCTYPE model [<!ENTITY l0 "lol">{laughs}]>'
    yield "laughs.3mf", _package(_model("", "", "&l11;", doctype)), _REFUSED


def _liars() -> Iterator[tuple[str, bytes, set[str | None]]]:
    """Headers that announce four thousand million of everything."""
    many = 4_000_000_000
    yield "huge.off", f"OFF\n{many} {many} 0\n0 0 0\n".encode(), _REFUSED
    for form in ("ascii", "binary_little_endian"):
        head = f"ply\nformat {form} 1.0\nelement vertex {many}\nproperty float x\nproperty float y\nproperty float z\n"
        text = f"{head}element face {many}\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n"
        yield f"huge-{form}.ply", text.encode(), _REFUSED
    yield "huge.stl", bytes(80) + struct.pack("<I", many) + bytes(50), _REFUSED
    yield "huge.obj", b"v 0 0 0\nf 1 2 4000000000\nf -4000000000 1 1\n", _REFUSED
    accessor = {"componentType": 5126, "count": 2_000_000_000, "type": "VEC3"}
    yield "zeros.glb", _glb({"accessors": [accessor]}), _REFUSED
    yield "negative.glb", _glb({"accessors": [accessor | {"count": -1}]}), _REFUSED
    sparse = {"count": 2_000_000_000, "indices": {"bufferView": 0, "componentType": 5125}, "values": {"bufferView": 0}}
    yield "sparse.glb", _glb({"accessors": [accessor | {"sparse": sparse}]}), _REFUSED


def _crowds() -> Iterator[tuple[str, bytes, set[str | None]]]:
    """One small mesh with very many instances."""
    doublings = "".join(
        f'<object id="{n}" type="model"><components>{f"""<component objectid="{n - 1}"/>""" * 2}</components></object>'
        for n in range(2, 34)
    )
    yield "crowd.3mf", _package(_model(_TETRAHEDRON + doublings, '<item objectid="33"/>')), _REFUSED
    circle = '<object id="2" type="model"><components><component objectid="2"/></components></object>'
    yield "circle.3mf", _package(_model(_TETRAHEDRON + circle, '<item objectid="2"/>')), _REFUSED
    accessor = {"bufferView": 0, "componentType": 5126, "count": 30_000, "type": "VEC3"}
    nodes = [{"mesh": 0}] * 20_000
    crowd = {"accessors": [accessor], "nodes": nodes, "scenes": [{"nodes": list(range(len(nodes)))}]}
    yield "crowd.glb", _glb(crowd, bytes(360_000)), _REFUSED
    deep = [{"children": [n + 1]} for n in range(50_000)] + [{"mesh": 0}]
    yield "deep.glb", _glb({"accessors": [accessor | {"count": 3}], "nodes": deep}, bytes(36)), _ANYTHING
    yield "deep.gltf", b'{"asset":' + b"[" * 200_000, _REFUSED


def _readers(target_url: str, secret: str) -> Iterator[tuple[str, bytes, set[str | None]]]:
    """Files that refer to other files and URLs."""
    entity = f'<!DOCTYPE model [<!ENTITY x SYSTEM "file://{secret}"><!ENTITY y SYSTEM "{target_url}/entity">]>'
    yield "entity.3mf", _package(_model(_TETRAHEDRON, '<item objectid="1"/>', "&x;&y;", entity)), _REFUSED
    yield (
        "library.obj",
        f"mtllib {secret}\nmtllib {target_url}/m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".encode(),
        _ANYTHING,
    )
    for number, uri in enumerate((secret, f"file://{secret}", "../../../../etc/passwd", f"{target_url}/buffer")):
        accessor = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
        document = _document({"accessors": [accessor]}, {"uri": uri, "byteLength": 36})
        yield f"uri{number}.gltf", json.dumps(document).encode(), _REFUSED
    outside = {"../../../../tmp/PWNED": b"x", "/etc/PWNED": b"x"}
    yield "outside.3mf", _package(_model(_TETRAHEDRON, '<item objectid="1"/>'), outside), _ANYTHING


def _chameleons() -> Iterator[tuple[str, bytes, set[str | None]]]:
    """Files that are something else too, or nothing, and names that are paths."""
    page = b"<html><script>alert(1)</script></html>"
    yield "page.stl", page.ljust(80) + struct.pack("<I", 1) + bytes(50), _ANYTHING
    yield "page.obj", b"# " + page + b"\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", _ANYTHING
    yield "picture.ply", b"GIF89a" + bytes(200), _REFUSED
    yield "../../../../tmp/PWNED.off", b"OFF\n0 0 0\n", _REFUSED
    yield "..\\..\\PWNED.off\x00.png", b"OFF\nnan nan nan\n", _REFUSED
    yield "/etc/cron.d/PWNED", bytes(range(256)) * 40, _REFUSED
    yield "nan.off", b"OFF\n3 1 0\nnan 0 0\n1e999 0 0\n0 1 0\n3 0 1 2\n", _REFUSED


def _deflated(size: int) -> bytes:
    """A gzip file of ``size`` spaces, composed in pieces."""
    target = io.BytesIO()
    with gzip.GzipFile(fileobj=target, mode="wb", compresslevel=1, mtime=0) as file:
        for _ in range(size >> 20):
            file.write(b" " * 2**20)
    return target.getvalue()


def _spaces() -> Iterator[bytes]:
    yield _model(_TETRAHEDRON, '<item objectid="1"/>').encode()
    for _ in range(_BOMB_BYTES >> 20):
        yield b" " * 2**20


def _model(objects: str, items: str, metadata: str = "", doctype: str = "") -> str:
    return (
        f'<?xml version="1.0"?>{doctype}<model xmlns="{_CORE}"><metadata name="a">{metadata}</metadata>'
        f"<resources>{objects}</resources><build>{items}</build></model>"
    )


def _package(model: str | Iterator[bytes], more: dict[str, bytes] | None = None) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as package:
        package.writestr("_rels/.rels", _RELATIONSHIPS)
        for name, content in (more or {}).items():
            package.writestr(name, content)
        with package.open("3D/3dmodel.model", "w", force_zip64=True) as part:
            for piece in [model.encode()] if isinstance(model, str) else model:
                part.write(piece)
    return target.getvalue()


def _document(more: dict[str, object], buffer: dict[str, object]) -> dict[str, object]:
    return {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "bufferViews": [{"buffer": 0, "byteLength": buffer["byteLength"]}],
        "buffers": [buffer],
    } | more


def _glb(more: dict[str, object], binary: bytes = bytes(36)) -> bytes:
    text = json.dumps(_document(more, {"byteLength": len(binary)})).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
