"""Parser for the XML of a 3MF model: its objects and the items of its build."""

from array import array
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias
from xml.parsers import expat

import numpy as np

from segcore.arrays import FloatArray
from segcore.errors import InvalidMesh, UnsupportedFormat
from segcore.io.limits import ReadLimits
from segcore.structure import NO_ENTRY

ObjectKey: TypeAlias = tuple[str, str]  # the model part, empty for the root model, and the id in it
MaterialKey: TypeAlias = tuple[str, str, str]  # the model part, the id of the resource, and the index in it or empty
Attributes: TypeAlias = dict[str, str]

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
_MATERIAL = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
# Required extensions that change neither the faces nor their positions, or that are implemented here.
_UNDERSTOOD = (
    _PRODUCTION,
    _MATERIAL,
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
)
_MILLIMETRES = {
    "micron": 1e-3, "millimeter": 1.0, "centimeter": 10.0, "inch": 25.4, "foot": 304.8, "meter": 1000.0,
}  # fmt: skip
_PATH = f"{_PRODUCTION} path"
_IDENTITY = np.eye(4)


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """An object with a transform: a component of another object, or an item of the build."""

    object: ObjectKey
    transform: FloatArray  # (4, 4) for column vectors


@dataclass(slots=True, eq=False)
class ModelObject:
    """An object: a mesh, a list of components, or neither."""

    name: str
    vertices: "array[float]" = field(default_factory=lambda: array("d"))  # x, y and z of each vertex
    triangles: "array[int]" = field(default_factory=lambda: array("i"))  # the three vertices of each triangle
    materials: "array[int]" = field(default_factory=lambda: array("i"))  # of each triangle, by number; -1 for none
    components: list[Placed] = field(default_factory=list)


class _Default(NamedTuple):
    """The properties of the triangles of an object that have none of their own."""

    resource: str | None
    material: int  # by number; -1 for none


@dataclass(slots=True, eq=False)
class Model:
    """The contents of a model part."""

    unit: float = 1.0  # millimetres
    objects: dict[str, ModelObject] = field(default_factory=dict)
    items: list[Placed] = field(default_factory=list)


def parse_model(chunks: Iterable[bytes], part: str, limits: ReadLimits, materials: dict[MaterialKey, int]) -> Model:
    """Parse a model part; entities are not expanded, and no other part or file is read.

    Parameters
    ----------
    part : the name of the part, empty for the root model.
    materials : the numbers of all materials so far; those of this part are added.

    Raises
    ------
    InvalidMesh, UnsupportedFormat, LimitExceeded
        The message of InvalidMesh has the line.
    """
    return _ModelParser(part, limits, materials).parse(chunks)


class _ModelParser:
    def __init__(self, part: str, limits: ReadLimits, materials: dict[MaterialKey, int]) -> None:
        self._part = part
        self._limits = limits
        self._materials = materials
        self._palettes: set[str] = set()  # resources with a material per index; others have texture coordinates
        self._default = _Default(None, NO_ENTRY)
        self._model = Model()
        self._object = ModelObject("")
        self._namespaces: dict[str, str] = {}
        self._parser = expat.ParserCreate(namespace_separator=" ")
        self._parser.buffer_text = True
        self._parser.StartElementHandler = self._start
        self._parser.StartDoctypeDeclHandler = self._refuse_doctype
        self._parser.StartNamespaceDeclHandler = self._declare
        self._handlers = {
            f"{_CORE} vertex": self._vertex,
            f"{_CORE} triangle": self._triangle,
            f"{_CORE} object": self._begin_object,
            f"{_CORE} component": self._component,
            f"{_CORE} item": self._item,
            f"{_CORE} model": self._begin_model,
            f"{_CORE} basematerials": self._palette,
            f"{_MATERIAL} colorgroup": self._palette,
        }
        self._has_model = False

    def parse(self, chunks: Iterable[bytes]) -> Model:
        try:
            for chunk in chunks:
                self._parser.Parse(chunk, False)
            self._parser.Parse(b"", True)
        except expat.ExpatError as error:
            raise InvalidMesh(
                f"Line {error.lineno}: the XML of the 3MF model is damaged ({expat.ErrorString(error.code)})."
            ) from error
        except (LookupError, ValueError, OverflowError) as error:
            raise InvalidMesh(
                f"Line {self._parser.CurrentLineNumber}: an attribute in the 3MF model is missing or wrong."
            ) from error
        if not self._has_model:
            raise InvalidMesh("The 3MF model is XML, but has no element 'model' of the 3MF core specification.")
        return self._model

    def _start(self, name: str, attributes: Attributes) -> None:
        handler = self._handlers.get(name)
        if handler is not None:
            handler(attributes)

    def _vertex(self, attributes: Attributes) -> None:
        x, y, z = attributes["x"], attributes["y"], attributes["z"]
        if "_" in x or "_" in y or "_" in z:
            raise ValueError("a number with an underscore, which Python would accept")
        self._object.vertices.extend((float(x), float(y), float(z)))
        if len(self._object.vertices) > 3 * self._limits.max_vertices:
            self._limits.check_vertices(len(self._object.vertices) // 3)

    def _triangle(self, attributes: Attributes) -> None:
        a, b, c = attributes["v1"], attributes["v2"], attributes["v3"]
        if "_" in a or "_" in b or "_" in c:
            raise ValueError("a number with an underscore, which Python would accept")
        self._object.triangles.extend((int(a), int(b), int(c)))
        self._object.materials.append(self._material_of(attributes) if "p1" in attributes else self._default.material)
        if len(self._object.triangles) > 3 * self._limits.max_faces:
            self._limits.check_faces(len(self._object.triangles) // 3)

    def _begin_model(self, attributes: Attributes) -> None:
        unit = attributes.get("unit", "millimeter")
        if unit not in _MILLIMETRES:
            raise InvalidMesh(f"The 3MF model is in {unit[:40]!r}, which is not a unit of 3MF: correct it.")
        self._model.unit = _MILLIMETRES[unit]
        self._has_model = True
        for prefix in attributes.get("requiredextensions", "").split():
            namespace = self._namespaces.get(prefix, prefix)
            if namespace not in _UNDERSTOOD:
                raise UnsupportedFormat(
                    f"The 3MF model requires the extension {namespace[:100]!r}: save it without that extension."
                )

    def _begin_object(self, attributes: Attributes) -> None:
        number = attributes["id"]
        if number in self._model.objects:
            raise InvalidMesh(f"Line {self._parser.CurrentLineNumber}: the 3MF model has two objects {number[:40]!r}.")
        self._object = self._model.objects[number] = ModelObject(attributes.get("name", ""))
        pid, index = attributes.get("pid"), attributes.get("pindex", "")
        self._default = _Default(pid, NO_ENTRY if pid is None else self._numbered(pid, index))

    def _palette(self, attributes: Attributes) -> None:
        self._palettes.add(attributes.get("id", ""))

    def _material_of(self, attributes: Attributes) -> int:
        """The number of the material of a triangle with properties of its own; its corners may differ in them."""
        pid, first = attributes.get("pid", self._default.resource), attributes["p1"]
        if pid is None:
            return NO_ENTRY
        is_uniform = attributes.get("p2", first) == first and attributes.get("p3", first) == first
        return self._numbered(pid, first if is_uniform else "")

    def _numbered(self, pid: str, index: str) -> int:
        key = (self._part, pid, index if pid in self._palettes else "")
        return self._materials.setdefault(key, len(self._materials))

    def _component(self, attributes: Attributes) -> None:
        self._object.components.append(self._placed(attributes))

    def _item(self, attributes: Attributes) -> None:
        self._model.items.append(self._placed(attributes))

    def _placed(self, attributes: Attributes) -> Placed:
        transform = attributes.get("transform")
        matrix = _IDENTITY if transform is None else _matrix(transform)
        return Placed((attributes.get(_PATH, self._part), attributes["objectid"]), matrix)

    def _declare(self, prefix: str | None, uri: str) -> None:
        self._namespaces[prefix or ""] = uri

    def _refuse_doctype(self, *_: object) -> None:
        raise InvalidMesh("The 3MF model has a document type declaration, which 3MF does not allow: save it again.")


def _matrix(text: str) -> FloatArray:
    """(4, 4) for column vectors, from the 4 rows of 3 numbers that the file has for row vectors."""
    values = [float(word) for word in text.split()]
    if len(values) != 12 or "_" in text or not np.isfinite(values).all():
        raise ValueError("a transform has 12 finite numbers")
    matrix = np.eye(4)
    matrix[:3] = np.array(values).reshape(4, 3).T
    return matrix
