"""The appearance of a glTF scene; anything that cannot be read is left out."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.appearance import (
    Appearance,
    appearance_or_none,
    color_bytes,
    group_appearance,
    texture_coordinates,
    unit_normals,
)
from segcore.arrays import FloatArray, transformed
from segcore.errors import CleaveError
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.scene import Instance, Primitive
from segcore.io.palette import srgb

_NORMAL, _UV, _COLOR = "NORMAL", "TEXCOORD_0", "COLOR_0"
_KINDS = {_NORMAL: ("VEC3",), _UV: ("VEC2",), _COLOR: ("VEC4", "VEC3")}


def gltf_appearance(parts: list[tuple[Instance, Primitive]], accessors: Accessors) -> Appearance | None:
    """Return the appearance of the vertices and faces of all primitives in the order of the reader, or None."""
    blocks: dict[tuple[int, bytes], tuple[Instance, list[Primitive]]] = {}
    for instance, primitive in parts:
        key = (primitive.positions, instance.transform.tobytes())
        blocks.setdefault(key, (instance, []))[1].append(primitive)
    normals = _rows(list(blocks.values()), accessors, _NORMAL)
    uvs = _rows(list(blocks.values()), accessors, _UV)
    colors = _rows(list(blocks.values()), accessors, _COLOR)
    groups = group_appearance([instance.name for instance, _ in parts], [part.face_count for _, part in parts])
    return appearance_or_none(
        Appearance(
            normals=None if normals is None else unit_normals(normals),
            uvs=None if uvs is None else texture_coordinates(uvs),
            colors=None if colors is None else _color_bytes(colors),
            face_group=None if groups is None else groups.face_group,
            group_names=() if groups is None else groups.group_names,
        )
    )


def _rows(blocks: list[tuple[Instance, list[Primitive]]], accessors: Accessors, name: str) -> FloatArray | None:
    """(V, *) an attribute of all vertices; None if a primitive lacks it, or two primitives contradict each other."""
    rows = [_block(instance, primitives, accessors, name) for instance, primitives in blocks]
    if any(values is None for values in rows) or len({values.shape[1] for values in rows if values is not None}) != 1:
        return None
    return np.concatenate([values for values in rows if values is not None])


def _block(instance: Instance, primitives: list[Primitive], accessors: Accessors, name: str) -> FloatArray | None:
    sources = {primitive.attributes.get(name) for primitive in primitives}
    source = sources.pop()
    if sources or type(source) is not int:
        return None
    values = _values(accessors, source, name)
    if values is None or len(values) != accessors.count(primitives[0].positions):
        return None
    if name != _NORMAL:
        return values
    return _transformed(values, instance.transform[:3, :3])


def _transformed(normals: FloatArray, matrix: FloatArray) -> FloatArray | None:
    """(V, 3) normals N after the transform M: rows of N inverse(M); None if M is singular."""
    try:
        return transformed(normals, np.asarray(np.linalg.inv(matrix).T, dtype=np.float64))
    except np.linalg.LinAlgError:
        return None


def _values(accessors: Accessors, source: int, name: str) -> FloatArray | None:
    for kind in _KINDS[name]:
        try:
            return accessors.read(source, kind).astype(np.float64)
        except CleaveError:
            continue
    return None


def _color_bytes(linear: NDArray[Any]) -> NDArray[np.uint8] | None:
    """(V, 4) sRGB bytes of linear colours in 0..1, or None if one is not finite."""
    encoded = np.clip(linear, 0, 1)
    encoded[:, :3] = srgb(encoded[:, :3])
    return color_bytes(encoded) if np.isfinite(encoded).all() else None
