"""Nearly valid files: samples of every format after changes of what readers rely on."""

import gzip
import io
import re
import struct
import zipfile
import zlib
from functools import cache

from hypothesis import strategies as st

from helpers.files.compressed_gltf import draco_asset, meshopt_asset
from helpers.files.posed import blended, copied, morphed
from helpers.files.samples import BINARY_STL, DRESSED, OBJ, OFF, SAMPLES, SQUARE, gltf_with_buffer
from helpers.files.slicer_projects import bambu_project, prusa, prusa_project
from helpers.files.threemf import Model3MF
from helpers.uploads import zip_of
from segcore.io.zip_members import ZIP_MAGIC

NUMBER = re.compile(rb"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
WORDS = [
    b"0", b"-1", b"1", b"3", b"2147483647", b"-2147483648", b"4294967295", b"9223372036854775808", b"1e308", b"1e999",
    b"nan", b"-inf", b"0x10", b"1_0", b"1.5", b"", b"\xff", b"\0", b"1" * 400,
]  # fmt: skip
INTEGERS = [0, 1, 2, 3, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x3F800000, 0x7FC00000]
KEYWORDS = {
    "off": [b"OFF", b"COFF", b"NOFF", b"STOFF", b"4OFF", b"nOFF", b"BINARY", b"#", b"\n", b"\r", b"\t"],
    "stl": [b"solid", b"endsolid", b"facet", b"endfacet", b"outer loop", b"endloop", b"vertex", b"normal", b"\n"],
    "ply": [b"element", b"property", b"list", b"format", b"ascii", b"binary_big_endian", b"end_header", b"comment",
            b"uchar", b"int", b"float", b"double", b"vertex", b"face", b"tristrips", b"vertex_indices", b"\n"],
    "obj": [b"v", b"vt", b"vn", b"f", b"g", b"o", b"usemtl", b"mtllib", b"/", b"//", b"\\\n", b"#", b"\n", b"l", b"p"],
    "glb": [b'"count":', b'"byteOffset":', b'"byteStride":', b'"sparse":{}', b'"normalized":true', b"[", b"]", b"{",
            b"}", b"null", b'"matrix":[]', b'"mode":5', b'"extensions":{}', b'"bufferView":0', b'"children":[0]'],
    "3mf": [b"<vertex", b"<triangle", b"<component", b"<item", b"<object", b"/>", b"&amp;", b"<!--", b"<!DOCTYPE x []>",
            b'transform="1 0 0 0 1 0 0 0 1 0 0 0"', b'objectid="1"', b'unit="inch"', b"<![CDATA[", b"xmlns=",
            b"<volume", b"<part", b"<metadata", b'key="modifier"', b'subtype="negative_part"', b'firstid="1"'],
}  # fmt: skip
KEYWORDS["gltf"] = KEYWORDS["glb"]


@st.composite
def mutated(draw: st.DrawFn, name: str) -> bytes:
    """A file of the format called ``name`` after one to eight changes, sometimes cut, joined or compressed."""
    seeds = _seeds(name)
    data = draw(st.sampled_from(seeds))
    if data.startswith(ZIP_MAGIC) and draw(st.integers(0, 3)):
        return _changed_inside(draw, data, name)
    data = changed(draw, data, name)
    if not draw(st.integers(0, 9)):
        data = data[: draw(st.integers(0, len(data)))] + draw(st.sampled_from(seeds))
    if not draw(st.integers(0, 19)):
        data = changed(draw, zlib.compress(data, wbits=31), name)
    return data


@st.composite
def mutated_set(draw: st.DrawFn) -> bytes:
    """A ZIP archive of a model and the files that belong to it, after changes of its bytes or of its members."""
    data = draw(st.sampled_from(_sets()))
    return _changed_inside(draw, data, "gltf") if draw(st.integers(0, 2)) else changed(draw, data, "gltf")


def _changed_inside(draw: st.DrawFn, data: bytes, name: str) -> bytes:
    """A ZIP archive with one to three changed members, of which the names may change, too."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {member: archive.read(member) for member in archive.namelist()}
    for _ in range(draw(st.integers(1, 3))):
        member = draw(st.sampled_from(list(members)))
        if draw(st.integers(0, 9)):
            members[member] = changed(draw, members[member], name)
        else:
            renamed = changed(draw, member.encode(), name).decode("utf-8", "replace").replace("\0", "") or "empty"
            members[renamed] = members.pop(member)
    return zip_of(members)


@cache
def _seeds(name: str) -> list[bytes]:
    more = {"glb": _posed_and_compressed, "3mf": _projects}
    return SAMPLES[name] + DRESSED[name] + (more[name]() if name in more else [])


def _posed_and_compressed() -> list[bytes]:
    assets = [blended(), copied(), morphed([0.5, 3]), meshopt_asset(), draco_asset()[0]]
    return [asset.glb() for asset in assets]


def _projects() -> list[bytes]:
    model = Model3MF("inch")
    square = model.mesh(SQUARE, "square")
    model.item(model.assembly([(square, None), (square, [2.0, 0, 0, 0, -1, 0, 0, 0, 1, 5, 6, 7])]))
    settings = prusa(2, 3, ("name", "cutter"), ("volume_type", "NegativeVolume"))
    parts = bambu_project(["normal_part", "negative_part", "support_blocker"])
    return [model.package(), prusa_project(settings), parts]


@cache
def _sets() -> list[bytes]:
    text, binary = gltf_with_buffer("data/scene.bin")
    materials = {"m/a.mtl": b"newmtl red\nKd 1 0 0\nmap_Kd a.png\n", "m/a.png": b"\x89PNG", "readme.txt": b"hello"}
    sets = [
        {"m/scene.gltf": text, "m/data/scene.bin": binary},
        {"m/a.obj": b"mtllib a.mtl\nusemtl red\n" + OBJ, **materials},
        {"a.off.gz": gzip.compress(OFF), "__MACOSX/._a.off": b"\0\5"},
        {"a.stl": BINARY_STL},
        {"a.3mf": SAMPLES["3mf"][0]},
    ]
    return [zip_of(members) for members in sets]


def changed(draw: st.DrawFn, data: bytes, name: str) -> bytes:
    for _ in range(draw(st.integers(1, 8))):
        data = draw(st.sampled_from(CHANGES))(draw, data, name)
    return data


def _swap_number(draw: st.DrawFn, data: bytes, _: str) -> bytes:
    found = list(NUMBER.finditer(data))
    if not found:
        return data
    number = draw(st.sampled_from(found))
    return data[: number.start()] + draw(st.sampled_from(WORDS)) + data[number.end() :]


def _put_integer(draw: st.DrawFn, data: bytes, _: str) -> bytes:
    at = draw(st.integers(0, len(data)))
    form = draw(st.sampled_from(["<B", "<H", ">H", "<I", ">I"]))
    number = struct.pack(form, draw(st.sampled_from(INTEGERS)) & (256 ** struct.calcsize(form) - 1))
    return data[:at] + number + data[at + len(number) :]


def _put_bytes(draw: st.DrawFn, data: bytes, _: str) -> bytes:
    at, length = draw(st.integers(0, len(data))), draw(st.integers(0, 8))
    return data[:at] + draw(st.binary(max_size=8)) + data[at + length :]


def _put_keyword(draw: st.DrawFn, data: bytes, name: str) -> bytes:
    at = draw(st.integers(0, len(data)))
    return data[:at] + b" " + draw(st.sampled_from(KEYWORDS[name])) + b" " + data[at:]


def _repeat(draw: st.DrawFn, data: bytes, _: str) -> bytes:
    at, length = draw(st.integers(0, len(data))), draw(st.integers(0, 60))
    return data[:at] + data[at : at + length] * draw(st.integers(2, 5)) + data[at + length :]


def _lose(draw: st.DrawFn, data: bytes, _: str) -> bytes:
    at, length = draw(st.integers(0, len(data))), draw(st.integers(0, 60))
    return data[:at] + data[at + length :]


CHANGES = (_swap_number, _swap_number, _put_integer, _put_bytes, _put_keyword, _repeat, _lose)
