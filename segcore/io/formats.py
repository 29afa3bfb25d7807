"""FORMATS, the list of every mesh format that can be read, and their detection by content, not by file name."""

import os
import re
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Literal, TypeAlias

from segcore.coordinates import UNKNOWN, Coordinates
from segcore.errors import UnsupportedFormat
from segcore.io.source import GZIP_MAGIC
from segcore.io.zip_members import ZIP_MAGIC

# Choices in what is written: the nodes of GLB, the colours of PLY, and the files of parts in a ZIP archive.
Layout: TypeAlias = Literal["tree", "flat"]
PlyColors: TypeAlias = Literal["vertices", "faces"]
PartFormat: TypeAlias = Literal["stl", "obj", "glb"]


@dataclass(frozen=True, slots=True)
class Format:
    """The names of a mesh format, and what its coordinates mean."""

    title: str
    extensions: tuple[str, ...]  # with the dot, the usual one first
    media_types: tuple[str, ...]  # the usual one first
    coordinates: Coordinates = UNKNOWN


_GLTF_COORDINATES = Coordinates("meter", "y")

FORMATS: dict[str, Format] = {
    "off": Format("OFF", (".off", ".coff", ".noff", ".cnoff"), ("model/off", "application/off", "application/x-off")),
    "stl": Format(
        "STL",
        (".stl", ".stla", ".stlb"),
        ("model/stl", "application/sla", "application/vnd.ms-pki.stl"),
        Coordinates(usual_up="z"),
    ),
    "ply": Format("PLY", (".ply",), ("model/ply", "application/ply", "application/x-ply")),
    "obj": Format("OBJ", (".obj",), ("model/obj", "application/x-tgif")),
    "glb": Format("GLB", (".glb",), ("model/gltf-binary",), _GLTF_COORDINATES),
    "gltf": Format("glTF", (".gltf",), ("model/gltf+json",), _GLTF_COORDINATES),
    "3mf": Format(
        "3MF",
        (".3mf",),
        ("model/3mf", "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"),
        Coordinates("millimeter", "z", "z"),  # the reader converts other units to millimetres
    ),
}

_BOM = b"\xef\xbb\xbf"
_OFF = re.compile(rb"(?:\s++|#[^\r\n]*+[\r\n])*+(?:ST|[CN4n])*+OFF")
_PLY = re.compile(rb"ply[ \t]*+[\r\n]", re.IGNORECASE)
_ASCII_STL = re.compile(  # up to 20 other lines may stand between the line of the solid and the first face
    rb"(?:\s++|#[^\r\n]*+[\r\n])*+solid\b[^\r\n]*+(?:[\r\n]\s*+(?!facet\s|end[ \t_-]*+solid)[^\r\n]*+){0,20}+"
    rb"[\r\n]\s*+(?:facet\s|end[ \t_-]*+solid)",
    re.IGNORECASE,
)
_SOLID = re.compile(rb"(?:\s++|#[^\r\n]*+[\r\n])*+solid\b", re.IGNORECASE)
_MARKUP = re.compile(rb"(?:\s++|<\?.*?\?>|<!--.*?-->)*+<(!doctype\s++)?+([a-z][\w:.-]*+)", re.IGNORECASE | re.DOTALL)
_HTML = (b"html", b"head", b"body", b"title", b"meta", b"script", b"div", b"center", b"h1", b"p", b"pre")
# Roots of XML formats with meshes.
_XML_MESHES = (b"collada", b"x3d", b"amf", b"model", b"vtkfile", b"kml", b"citymodel", b"scene", b"mesh")
_JSON_MESH = re.compile(rb'"(?:asset|meshes|accessors|buffers|bufferViews|nodes|scenes|scene|extensions)"\s*+:')
_MARKUP_BYTES = 2**12  # from the beginning of a file, in which its first element is looked for
_OBJ = re.compile(rb"(?:\s++|#[^\r\n]*+[\r\n])*+(?:v|vt|vn|vp|f|l|p|g|o|s|mg|usemtl|mtllib)(?=[ \t])")
_OBJ_VERTEX = re.compile(rb"(?:^|[\r\n])[ \t]*+v[ \t]")
_GLTF = re.compile(rb"\s*+\{")
_ZIP_NAME = 30  # the offset of the name of the first member of an archive
_RESULT_MEMBER = b"header.json"  # the first member of a .cleave file
_FOREIGN = {
    ZIP_MAGIC: "a ZIP archive, but not 3MF",
    b"Kaydara FBX Binary": "FBX",
    b"<?xml": "XML (COLLADA, X3D or other)",
    b"ISO-10303-21": "STEP",
    b"#VRML": "VRML",
    b"BZh": "compressed with bzip2",
    b"\xfd7zXZ": "compressed with xz",
    b"\x28\xb5\x2f\xfd": "compressed with zstd",
    GZIP_MAGIC: "compressed twice",
    b"\xff\xfe": "text in UTF-16",
    b"\xfe\xff": "text in UTF-16",
}
_STL_HEADER, _STL_FACE = 84, 50  # bytes


def declared_format(source: str | os.PathLike[str] | BinaryIO, declaration: str | None) -> str | None:
    """Return the format by the declaration of a caller, else by the extension of a path: a key of FORMATS, or None.

    Raises
    ------
    UnsupportedFormat
        If ``declaration`` is not a name, extension or media type of a format in FORMATS.
    """
    if declaration is not None:
        return _named(declaration)
    if isinstance(source, str | os.PathLike):
        path = Path(source)
        extension = Path(path.stem).suffix if path.suffix.lower() == ".gz" else path.suffix
        return next((name for name, form in FORMATS.items() if extension.lower() in form.extensions), None)
    return None


def detect_format(data: bytes, declared: str | None) -> str:
    """Return the format of a file, a key of FORMATS; the declared one counts only if the content does not decide.

    Raises
    ------
    UnsupportedFormat
        If the content has another format than the declared one, or one that cannot be read.
    """
    page = _page(data)
    if page is not None:
        raise UnsupportedFormat(f"The file is {page}, not a mesh: download the mesh itself and send that.")
    found = _found(data)
    if found is not None and declared in (None, found):
        return found
    foreign = FORMATS[found].title if found else _foreign(data)
    if declared is not None and foreign is not None:
        raise UnsupportedFormat(
            f"The file is declared or named as {FORMATS[declared].title}, but its content is {foreign}: "
            "correct the name or send the other file."
        )
    if declared is not None:
        return declared
    content = "of no known mesh format" if foreign is None else foreign
    raise UnsupportedFormat(f"The content of the file is {content}: convert it to {_titles()}.")


def is_plain_archive(data: bytes) -> bool:
    """Whether a file is a ZIP archive that is neither 3MF nor a .cleave file."""
    return data.startswith(ZIP_MAGIC) and b".model" not in data and not data.startswith(_RESULT_MEMBER, _ZIP_NAME)


def is_ascii_stl(data: bytes) -> bool:
    """Whether an STL file is text; a binary one may begin with the word ``solid`` too."""
    if _fills_stl(data):
        return False
    text = data.removeprefix(_BOM)
    first = text.rstrip(b"\0")[: _STL_HEADER + _STL_FACE]
    return _ASCII_STL.match(text) is not None or (_SOLID.match(text) is not None and b"\0" not in first)


def _named(declaration: str) -> str:
    wanted = declaration.partition(";")[0].strip().lower()
    for name, form in FORMATS.items():
        if wanted == name or wanted in form.media_types or f".{wanted.removeprefix('.')}" in form.extensions:
            return name
    raise UnsupportedFormat(f"There is no reader for {declaration!r}: convert the mesh to {_titles()}.")


def _titles() -> str:
    *first, last = (form.title for form in FORMATS.values())
    return f"{', '.join(first)} or {last}"


def _foreign(data: bytes) -> str | None:
    """The name of a known format that has no reader, or None."""
    if data.startswith(ZIP_MAGIC) and data.startswith(_RESULT_MEMBER, _ZIP_NAME):
        return "a .cleave file, which cleave convert opens"
    return next((title for magic, title in _FOREIGN.items() if data.startswith(magic)), None)


def _page(data: bytes) -> str | None:
    """What a file is if it is an answer of a server that was saved in place of a mesh, else None."""
    if data.startswith(b"version https://git-lfs"):
        return "a pointer of Git LFS"
    text = data[:_MARKUP_BYTES].removeprefix(_BOM)
    if _GLTF.match(text):
        return None if _JSON_MESH.search(data) or b"\0" in text else "a JSON document"
    root = None if _fills_stl(data) else _MARKUP.match(text)
    if root is None:
        return None
    name = root[2].lower()
    if name in _HTML:
        return "a page of HTML"
    if root[1] or name.rpartition(b":")[2] in _XML_MESHES:
        return None
    return f"an XML document <{root[2].decode('ascii', 'replace')[:40]}>"


def _found(data: bytes) -> str | None:
    if data.startswith(b"glTF"):
        return "glb"
    if data.startswith(ZIP_MAGIC) and b".model" in data:
        return "3mf"
    if _PLY.match(data):
        return "ply"
    if _fills_stl(data):
        return "stl"
    text = data.removeprefix(_BOM)
    if _OFF.match(text):
        return "off"
    if _GLTF.match(text):
        return "gltf"
    if _ASCII_STL.match(text):
        return "stl"
    if _OBJ.match(text) and _OBJ_VERTEX.search(text):
        return "obj"
    return "stl" if _mostly_stl(data) else None


def _fills_stl(data: bytes) -> bool:
    return len(data) > _STL_HEADER and len(data) == _stl_size(data)


def _mostly_stl(data: bytes) -> bool:
    """Whether the faces of a binary STL file are at least half of its bytes; some programs append bytes to them."""
    return len(data) > _STL_HEADER and len(data) // 2 <= _stl_size(data) <= len(data)


def _stl_size(data: bytes) -> int:
    return _STL_HEADER + _STL_FACE * int(struct.unpack_from("<I", data, 80)[0])
