"""Volumes of slicer projects that are no part of the body: negative volumes, modifiers, support blockers and enforcers.

PrusaSlicer and its relatives list ranges of the triangles of an object, Bambu Studio and OrcaSlicer its components.
"""

from array import array
from collections.abc import Iterable
from dataclasses import dataclass, field
from xml.parsers import expat

import numpy as np

from segcore.arrays import BoolArray
from segcore.errors import InvalidMesh, UnsupportedFormat
from segcore.io.names import one_line
from segcore.io.threemf.model import Attributes, Model, ModelObject
from segcore.io.threemf.package import Package

_BAMBU = "metadata/model_settings.config"
_PRUSA = "_model.config"  # Metadata/Slic3r_PE_model.config; relatives write another name before the underscore
_LARGEST = 2**24  # bytes of a settings file, set by hand; 10,000 volumes take about 6 MB
_NAMED = 5  # volumes that a note names
_LONGEST_NAME = 40
_KINDS = {
    "NegativeVolume": "negative volume",
    "ParameterModifier": "modifier",
    "SupportBlocker": "support blocker",
    "SupportEnforcer": "support enforcer",
    "SeamPosition": "seam position",  # SuperSlicer
    "negative_part": "negative volume",
    "modifier_part": "modifier",
    "support_blocker": "support blocker",
    "support_enforcer": "support enforcer",
}


@dataclass(frozen=True, slots=True)
class _Volume:
    """A volume that is no part of the body."""

    object: str  # the id of the object of the root model that it is in
    title: str
    part: str | None  # the id of a component, or None
    first: int = 0  # triangles of the object if there is no component
    last: int = -1


@dataclass(slots=True, eq=False)
class _Open:
    """A volume whose element has not ended."""

    attributes: Attributes
    values: dict[str, str] = field(default_factory=dict)


def leave_out_volumes(model: Model, package: Package) -> list[str]:
    """Remove volumes that are no part of the body from the root model; return notes.

    Settings that are damaged or larger than usual are ignored and noted.

    Raises
    ------
    LimitExceeded
    """
    notes = []
    titles = []
    for name in package.normal_names:
        if name != _BAMBU and not (name.startswith("metadata/") and name.endswith(_PRUSA)):
            continue
        try:
            if package.size(name) > _LARGEST:
                raise InvalidMesh("too large")
            volumes = _SettingsParser().parse(package.chunks(name))
        except (InvalidMesh, UnsupportedFormat, expat.ExpatError, LookupError, ValueError):
            notes.append(
                f"The settings of the slicer in {_short(name)} are damaged or too large and are ignored: volumes that "
                "are no part of the body may be read as parts."
            )
            continue
        titles += _remove(model, volumes)
    if titles:
        more = f" and {len(titles) - _NAMED} more" if len(titles) > _NAMED else ""
        count = "1 volume that is" if len(titles) == 1 else f"{len(titles)} volumes that are"
        verb = "is" if len(titles) == 1 else "are"
        notes.append(f"{count} no part of the body {verb} left out: {', '.join(titles[:_NAMED])}{more}.")
    return notes


class _SettingsParser:
    def __init__(self) -> None:
        self._object = ""
        self._open: _Open | None = None
        self._found: list[_Volume] = []
        self._parser = expat.ParserCreate()
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.StartDoctypeDeclHandler = self._refuse_doctype

    def parse(self, chunks: Iterable[bytes]) -> list[_Volume]:
        for chunk in chunks:
            self._parser.Parse(chunk, False)
        self._parser.Parse(b"", True)
        return self._found

    def _start(self, name: str, attributes: Attributes) -> None:
        if name == "object":
            self._object = attributes.get("id", "")
        elif name in ("volume", "part"):
            self._open = _Open(attributes)
        elif name == "metadata" and self._open is not None:
            self._open.values[attributes.get("key", "")] = attributes.get("value", "")

    def _end(self, name: str) -> None:
        if name in ("volume", "part") and self._open is not None:
            attributes, values = self._open.attributes, self._open.values
            self._open = None
            kind = _KINDS.get(attributes.get("subtype", "") if name == "part" else _volume_type(values))
            if kind is None:
                return
            title = f"{_short(values.get('name', '')) or 'without a name'} ({kind})"
            if name == "part":
                self._found.append(_Volume(self._object, title, attributes.get("id", "")))
            else:
                first, last = (_whole(attributes.get(key, "")) for key in ("firstid", "lastid"))
                self._found.append(_Volume(self._object, title, None, first, last))

    def _refuse_doctype(self, *_: object) -> None:
        raise InvalidMesh("a document type declaration")


def _volume_type(values: dict[str, str]) -> str:
    """The type of a volume; early versions only say whether it is a modifier."""
    return values.get("volume_type", "ParameterModifier" if values.get("modifier") == "1" else "")


def _whole(text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) <= 18):
        raise ValueError("a whole number is missing")
    return int(text)


def _short(name: str) -> str:
    return one_line(name[:_LONGEST_NAME])


def _remove(model: Model, volumes: list[_Volume]) -> list[str]:
    """Remove volumes from the objects of a model; return the titles of those that it has."""
    of_object: dict[str, list[_Volume]] = {}
    for volume in volumes:
        of_object.setdefault(volume.object, []).append(volume)
    titles = []
    for number, own in of_object.items():
        if (target := model.objects.get(number)) is not None:
            titles += _remove_components(target, number, [volume for volume in own if volume.part is not None])
            titles += _remove_triangles(target, [volume for volume in own if volume.part is None])
    return titles


def _remove_components(target: ModelObject, number: str, volumes: list[_Volume]) -> list[str]:
    parts = {volume.part for volume in volumes}
    present = {component.object[1] for component in target.components}
    if number in parts and len(target.triangles):  # the only part of an object may be the object itself
        present.add(number)
        _keep(target, np.zeros(len(target.triangles) // 3, dtype=bool))
    target.components = [component for component in target.components if component.object[1] not in parts]
    return [volume.title for volume in volumes if volume.part in present]


def _remove_triangles(target: ModelObject, volumes: list[_Volume]) -> list[str]:
    count = len(target.triangles) // 3
    found = [volume for volume in volumes if volume.first <= volume.last < count]
    if found:
        depth = np.zeros(count + 1, dtype=np.int64)
        np.add.at(depth, [volume.first for volume in found], 1)
        np.add.at(depth, [volume.last + 1 for volume in found], -1)
        _keep(target, depth.cumsum()[:count] == 0)
    return [volume.title for volume in found]


def _keep(target: ModelObject, kept: BoolArray) -> None:
    """Keep some triangles (F,) of an object, and all vertices but those that only the others use."""
    faces = np.asarray(target.triangles, dtype=np.int32).reshape(-1, 3)
    vertices = np.asarray(target.vertices, dtype=np.float64).reshape(-1, 3)
    remaining = faces[kept]
    if faces.size and 0 <= faces.min() <= faces.max() < len(vertices):
        stays = np.ones(len(vertices), dtype=bool)
        stays[faces[~kept]] = False
        stays[remaining] = True
        remaining = (np.cumsum(stays) - 1).astype(np.int32)[remaining]
        vertices = vertices[stays]
    materials = np.asarray(target.materials, dtype=np.int32)[kept]
    target.triangles, target.materials = array("i", remaining.tobytes()), array("i", materials.tobytes())
    target.vertices = array("d", vertices.tobytes())
