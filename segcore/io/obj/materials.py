"""The materials of an OBJ file: MTL files of its set, and the pictures that they name."""

import math
import posixpath
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from urllib.parse import quote

from segcore.errors import InvalidMesh
from segcore.io.file_sets import Companions

_LIBRARY = re.compile(rb"^[ \t]*mtllib[ \t]+(\S[^\r\n]*)", re.MULTILINE)
_COLORS = {"kd": "diffuse", "ke": "emissive"}
_NUMBERS = {"ns": "shininess", "pr": "roughness", "pm": "metallic"}
_MAPS = ("map_kd", "map_ke", "map_ks", "map_d", "map_bump", "bump", "norm", "map_pr", "map_pm", "disp")
# Options of maps with the largest number of their values; those of -o, -s and -t may be fewer.
_OPTIONS = {
    "-blendu": 1, "-blendv": 1, "-boost": 1, "-bm": 1, "-cc": 1, "-clamp": 1, "-imfchan": 1, "-mm": 2,
    "-o": 3, "-s": 3, "-t": 3, "-texres": 1, "-type": 1,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class TextureMap:
    """A picture of a material, as an MTL file names it.

    Texture coordinates (u, v) of the OBJ file stand for (u, v) * scale + offset in the picture.
    """

    path: str  # relative to the folder of the MTL file
    offset: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)
    is_clamped: bool = False  # beyond 0..1 the picture is not repeated


@dataclass(slots=True)
class ObjMaterial:
    """A material of an MTL file; None for what the file does not say."""

    name: str
    library: str  # the MTL file, relative to the OBJ file
    diffuse: tuple[float, float, float] | None = None  # Kd
    emissive: tuple[float, float, float] | None = None  # Ke
    opacity: float = 1.0  # d, or 1 - Tr
    shininess: float | None = None  # Ns
    roughness: float | None = None  # Pr
    metallic: float | None = None  # Pm
    maps: dict[str, TextureMap] = field(default_factory=dict)  # by keyword in lower case, such as map_kd


def read_obj_materials(data: bytes, companions: Companions) -> dict[str, ObjMaterial]:
    """Return the materials of an OBJ file by name, from the MTL files that it names and that are in its set.

    A line with ``mtllib`` may name one file, also with blanks in its name, or several. If a name occurs twice, the
    first material counts. Lines that are not understood are ignored.
    A file that is damaged counts as missing.

    Raises
    ------
    LimitExceeded
        If a file of the set is too large.
    """
    found: dict[str, ObjMaterial] = {}
    for name, text in _libraries(data, companions):
        for material in parse_mtl(text, name):
            found.setdefault(material.name, material)
    return found


def material_files(data: bytes, companions: Companions) -> dict[str, bytes]:
    """Return the MTL files of an OBJ file and the pictures that they name, by their paths relative to the OBJ file.

    Files that are missing, and paths that lead out of the folder of the OBJ file, are left out.

    Raises
    ------
    LimitExceeded
        If a file of the set is too large.
    """
    files: dict[str, bytes] = {}
    for name, text in _libraries(data, companions):
        files.setdefault(posixpath.normpath(name), text)
        for material in parse_mtl(text, name):
            for texture in material.maps.values():
                picture = read_picture(companions, material, texture)
                path = posixpath.join(posixpath.dirname(name), texture.path.replace("\\", "/"))
                if picture is not None:
                    files.setdefault(posixpath.normpath(path), picture)
    return {name: content for name, content in files.items() if _is_inside(name)}


def _libraries(data: bytes, companions: Companions) -> Iterator[tuple[str, bytes]]:
    """The names and the contents of the MTL files that are in the set."""
    for match in _LIBRARY.finditer(data):
        rest = match[1].strip().decode("utf-8", "replace")
        for name in [rest] if _companion(companions, "", rest) is not None else rest.split():
            text = _companion(companions, "", name)
            if text is not None:
                yield name.replace("\\", "/"), text


def _is_inside(path: str) -> bool:
    return not path.startswith(("/", "../")) and path != ".." and ":" not in path.split("/")[0]


def parse_mtl(data: bytes, library: str) -> list[ObjMaterial]:
    """Return the materials of an MTL file in its order.

    Parameters
    ----------
    library : the path of the file, relative to the OBJ file.
    """
    materials: list[ObjMaterial] = []
    for line in data.decode("utf-8", "replace").splitlines():
        keyword, _, rest = line.strip().partition("#")[0].replace("\t", " ").partition(" ")
        keyword, rest = keyword.lower(), rest.strip()
        if keyword == "newmtl":
            materials.append(ObjMaterial(rest, library))
        elif materials and rest:
            _set(materials[-1], keyword, rest)
    return materials


def read_picture(companions: Companions, material: ObjMaterial, texture: TextureMap) -> bytes | None:
    """Return the bytes of a picture; None if the set does not have it, or it is damaged.

    It is looked for beside the MTL file, then beside the OBJ file, then under its name alone, because many programs
    write the path that it had on another machine.

    Raises
    ------
    LimitExceeded
        If the file is too large.
    """
    folder = posixpath.dirname(material.library.replace("\\", "/"))
    path = texture.path.replace("\\", "/")
    places = [(place, name) for name in (path, posixpath.basename(path)) for place in (folder, "")]
    return next((data for place in places if (data := _companion(companions, *place)) is not None), None)


def _companion(companions: Companions, folder: str, path: str) -> bytes | None:
    """A file of the set; paths of MTL files are not percent-encoded, as addresses of the set are."""
    name = posixpath.join(folder, path.replace("\\", "/"))
    if not path:
        return None
    try:
        return companions.read(quote(name, safe="/:"))
    except InvalidMesh:  # empty or damaged: the shape can be read without it
        return None


def _set(material: ObjMaterial, keyword: str, rest: str) -> None:
    numbers = _floats(rest)
    if keyword in _COLORS and numbers:
        red, green, blue = (numbers * 3)[:3] if len(numbers) < 3 else numbers[:3]  # one number is a grey
        setattr(material, _COLORS[keyword], (red, green, blue))
    elif keyword in _NUMBERS and numbers:
        setattr(material, _NUMBERS[keyword], numbers[0])
    elif keyword == "d" and (numbers := _floats(rest.removeprefix("-halo"))):
        material.opacity = min(max(numbers[0], 0.0), 1.0)
    elif keyword == "tr" and numbers:
        material.opacity = min(max(1.0 - numbers[0], 0.0), 1.0)
    elif keyword in _MAPS and (texture := _texture(rest)) is not None:
        material.maps[keyword] = texture


def _floats(text: str) -> list[float]:
    """The finite numbers at the beginning of a text."""
    values: list[float] = []
    for word in text.split():
        try:
            value = float(word)
        except ValueError:
            break
        if not math.isfinite(value):
            break
        values.append(value)
    return values


def _texture(text: str) -> TextureMap | None:
    values: dict[str, list[str]] = {}
    while text.startswith("-") and (option := text.split(None, 1)[0].lower()) in _OPTIONS:
        text = text.partition(" ")[2].strip()
        values[option] = []
        for i in range(_OPTIONS[option]):
            word, _, rest = text.partition(" ")
            if not rest or (i > 0 and not _floats(word)):
                break
            values[option].append(word)
            text = rest.strip()
    if not text:
        return None
    offset, scale = (_floats(" ".join(values.get(option, []))) for option in ("-o", "-s"))
    return TextureMap(text, _pair(offset, 0.0), _pair(scale, 1.0), values.get("-clamp") == ["on"])


def _pair(values: list[float], default: float) -> tuple[float, float]:
    first, second = [*values, default, default][:2]
    return first, second
