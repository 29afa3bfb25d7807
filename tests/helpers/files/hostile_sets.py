"""Models of several files of an attacker, each with the error codes that its job may end with."""

import io
import json
import stat
import zipfile
from collections.abc import Iterator

from helpers.files.samples import OBJ, gltf_square

Files = list[tuple[str, bytes]]

_REFUSED: set[str | None] = {"invalid_mesh", "unsupported_format", "limit_exceeded"}
_READ: set[str | None] = {None}
_BOMB_BYTES = 400 * 2**20


def hostile_sets(target_url: str, secret: str) -> Iterator[tuple[Files, set[str | None]]]:
    """Yield the files of each set and the codes that its job may end with, None for success.

    Parameters
    ----------
    target_url : the URL in files that try to make the server connect to it.
    secret : the path in files that try to read another file.
    """
    climbing = "../" * 12 + secret.lstrip("/")
    for uri in (secret, climbing, f"file://{secret}", f"{target_url}/set.bin", "%2e%2e/" * 12 + secret.lstrip("/")):
        yield [("a.gltf", _gltf(uri)), ("a.bin", b"")], _REFUSED
        library = f"mtllib {uri}\nmtllib a.mtl\n".encode() + OBJ
        yield [("a.obj", library), ("a.mtl", f"newmtl a\nmap_Kd {uri}\n".encode())], _READ
        yield [("set.zip", _archive([("a.gltf", _gltf(uri)), ("a.bin", b"")]))], _REFUSED
        yield [("set.zip", _archive([("a.obj", library), (climbing, b"x"), (secret, b"x")]))], _READ
    yield [("set.zip", _archive([("a.gltf", _gltf("a.bin"))], links={"a.bin": secret}))], _REFUSED
    yield [("set.zip", _archive([], links={"a.obj": secret}))], _REFUSED
    yield [("set.zip", _archive([("a.gltf", _gltf("bomb.bin")), ("bomb.bin", bytes(_BOMB_BYTES))]))], _REFUSED | _READ
    yield [("set.zip", _archive([("a.obj", OBJ), *((f"{number}.png", b"") for number in range(10_001))]))], _REFUSED
    yield [("set.zip", _archive([("inner.zip", _archive([("a.obj", OBJ)]))]))], _REFUSED


def _gltf(uri: str) -> bytes:
    asset = gltf_square()
    asset.document["buffers"] = [{"byteLength": len(asset.binary), "uri": uri}]
    asset.document["images"] = [{"uri": uri}]
    return json.dumps(asset.document).encode()


def _archive(files: Files, links: dict[str, str] | None = None) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name, data in files:
            archive.writestr(name, data)
        for name, path in (links or {}).items():
            link = zipfile.ZipInfo(name)
            link.create_system = 3
            link.external_attr = (stat.S_IFLNK | 0o777) << 16
            archive.writestr(link, path)
    return target.getvalue()
