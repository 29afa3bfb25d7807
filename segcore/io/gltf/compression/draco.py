"""Decoder for primitives of glTF that are compressed with Draco (KHR_draco_mesh_compression)."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.errors import InvalidMesh, UnsupportedFormat
from segcore.io.gltf.document import Document, Item, integer, member, view_bytes

DRACO = "KHR_draco_mesh_compression"


@dataclass(frozen=True, slots=True, eq=False)
class DracoPrimitive:
    """The decoded data of a primitive."""

    attributes: dict[str, NDArray[Any]]  # (V, *) by semantic, such as POSITION
    corners: NDArray[np.uint32]  # (3 F, 1)


def decode_draco(document: Document, extension: Item, where: str) -> DracoPrimitive:
    """Decode the data of the extension of a primitive; its triangles are in the order of the decoder.

    Raises
    ------
    UnsupportedFormat
        If the optional package DracoPy is not installed.
    InvalidMesh
        If the data is damaged.
    """
    try:
        import DracoPy
    except ImportError:
        raise UnsupportedFormat(
            f"{where} of the glTF file is compressed with {DRACO}: run pip install 'cleave-mesh[draco]', "
            "or save the file without compression."
        ) from None
    data = bytes(view_bytes(document, integer(extension, "bufferView", where)))
    try:
        mesh = DracoPy.decode(data)
        corners = np.asarray(mesh.faces, dtype=np.uint32).reshape(-1, 1)
    except (DracoPy.FileTypeException, ValueError, AttributeError, MemoryError) as error:
        raise InvalidMesh(f"The data of {DRACO} in {where} of the glTF file is damaged.") from error
    names = member(extension, "attributes", where)
    by_id = {entry["unique_id"]: entry["data"] for entry in mesh.attributes}
    attributes = {name: by_id[number] for name in names if (number := integer(names, name, where)) in by_id}
    if "POSITION" not in attributes:
        raise InvalidMesh(f"The data of {DRACO} in {where} of the glTF file has no positions.")
    return DracoPrimitive(attributes, corners)
