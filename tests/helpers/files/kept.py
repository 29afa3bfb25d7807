"""Files that keep everything of their input, as the tests look at them."""

import io
import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np

from segcore.hierarchy import Hierarchy
from segcore.io import Original, ReadLimits, write_kept
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.document import read_document, view_bytes
from segcore.io.gltf.poses import Posed
from segcore.io.gltf.triangles import primitive_faces, scene_parts


def kept(data: bytes, hierarchy: Hierarchy, segments: int | None = None, **options: Any) -> bytes:
    """The output for a file in memory."""
    target = io.BytesIO()
    write_kept(target, Original(io.BytesIO(data)), hierarchy, segments, **options)
    return target.getvalue()


@dataclass
class Opened:
    """A GLB file."""

    data: bytes

    @property
    def document(self) -> dict[str, Any]:
        length = struct.unpack_from("<I", self.data, 12)[0]
        return json.loads(self.data[20 : 20 + length])

    def picture(self, index: int) -> bytes:
        document = read_document(self.data)
        return bytes(view_bytes(document, document.item("images", index)["bufferView"]))

    def numbers(self, accessor: int) -> np.ndarray:
        return Accessors(read_document(self.data), ReadLimits()).stored(accessor)

    def corners_by_part(self) -> dict[int | None, np.ndarray]:
        """(F, 9) the corners of the faces of each part in the scene; None for primitives without one."""
        document = read_document(self.data)
        accessors = Accessors(document, ReadLimits())
        found = scene_parts(document, accessors, ReadLimits())
        corners: dict[int | None, list[np.ndarray]] = {}
        for part in found.parts:
            entry = document.item("meshes", part.instance.mesh)["primitives"][part.primitive.index]
            posed: Posed = found.poses.place(part.pose)
            faces = primitive_faces(part.primitive, accessors)
            if posed.mirrored.all():
                faces = faces[:, [0, 2, 1]]
            rows = posed.positions[faces].reshape(-1, 9)
            corners.setdefault(entry.get("extras", {}).get("part"), []).append(rows)
        return {part: np.concatenate(rows) for part, rows in corners.items()}


def in_any_order(corners: np.ndarray) -> list[list[float]]:
    return sorted(np.round(corners.reshape(-1, 9), 6).tolist())
