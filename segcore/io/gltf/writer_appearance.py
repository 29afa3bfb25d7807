"""What the input said beside the shape, in a GLB file: attributes of vertices, and names of groups."""

from typing import Any

from numpy.typing import NDArray

from segcore.appearance import Appearance
from segcore.io.gltf.writer_views import append_view
from segcore.io.slices import Slices

_UNSIGNED_BYTE, _FLOAT = 5121, 5126
_ARRAY_BUFFER = 34962
_ATTRIBUTES = {
    "normals": ("NORMAL", "<f4", {"componentType": _FLOAT, "type": "VEC3"}),
    "uvs": ("TEXCOORD_0", "<f4", {"componentType": _FLOAT, "type": "VEC2"}),
    "colors": ("_COLOR_0", "u1", {"componentType": _UNSIGNED_BYTE, "type": "VEC4", "normalized": True}),
}


def add_attributes(document: dict[str, Any], blobs: list[NDArray[Any]], look: Appearance) -> None:
    """Give every primitive of a document the attributes of the vertices, and append their data to its blobs."""
    for kind, values in look.row_arrays.items():
        name, dtype, form = _ATTRIBUTES[kind]
        view = append_view(document, blobs, values.astype(dtype), target=_ARRAY_BUFFER)
        document["accessors"].append({"bufferView": view, "count": len(values), **form})
        for mesh in document["meshes"]:
            mesh["primitives"][0]["attributes"][name] = len(document["accessors"]) - 1


def name_groups(document: dict[str, Any], look: Appearance, slices: Slices) -> None:
    """Tell every node with faces which groups of the input reach into it."""
    if look.face_group is None:
        return
    for node in document["nodes"]:
        if "mesh" in node:
            node["extras"]["groups"] = look.groups_of(slices[node["mesh"]])
