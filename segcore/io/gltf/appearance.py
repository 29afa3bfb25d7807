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
from segcore.arrays import FloatArray
from segcore.errors import CleaveError
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.poses import Part, Pose, Poses
from segcore.io.gltf.scene import Primitive
from segcore.io.palette import srgb

_NORMAL, _UV, _COLOR = "NORMAL", "TEXCOORD_0", "COLOR_0"
_KINDS = {_NORMAL: ("VEC3",), _UV: ("VEC2",), _COLOR: ("VEC4", "VEC3")}


def gltf_appearance(parts: list[Part], poses: Poses, accessors: Accessors) -> Appearance | None:
    """Return the appearance of the vertices and faces of all primitives in the order of the reader, or None."""
    blocks: dict[Pose, list[Primitive]] = {}
    for part in parts:
        blocks.setdefault(part.pose, []).append(part.primitive)
    normals, uvs, colors = (_rows(blocks, poses, accessors, name) for name in (_NORMAL, _UV, _COLOR))
    groups = group_appearance([part.instance.name for part in parts], [part.primitive.face_count for part in parts])
    return appearance_or_none(
        Appearance(
            normals=None if normals is None else unit_normals(normals),
            uvs=None if uvs is None else texture_coordinates(uvs),
            colors=None if colors is None else _color_bytes(colors),
            face_group=None if groups is None else groups.face_group,
            group_names=() if groups is None else groups.group_names,
        )
    )


def _rows(blocks: dict[Pose, list[Primitive]], poses: Poses, accessors: Accessors, name: str) -> FloatArray | None:
    """(V, *) an attribute of all vertices; None if a primitive lacks it, or two primitives contradict each other."""
    rows: list[FloatArray] = []
    for pose, primitives in blocks.items():
        values = _block(pose, primitives, poses, accessors, name)
        if values is None or (rows and values.shape[1] != rows[0].shape[1]):
            return None
        rows.append(values)
    return np.concatenate(rows) if rows else None


def _block(pose: Pose, primitives: list[Primitive], poses: Poses, accessors: Accessors, name: str) -> FloatArray | None:
    sources = {primitive.attributes.get(name) for primitive in primitives}
    source = sources.pop()
    if sources or type(source) is not int:
        return None
    values = _values(accessors, source, name)
    if values is None or len(values) != accessors.count(pose.positions):
        return None
    try:
        return poses.normals(pose, values) if name == _NORMAL else poses.morphed(pose, name, values)
    except CleaveError:
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
