"""The appearance of the input in a GLB file: attributes of vertices, and names of groups."""

from segcore.appearance import Appearance
from segcore.io.gltf.glb_file import GlbFile
from segcore.io.slices import Slices

_UNSIGNED_BYTE, _FLOAT = 5121, 5126
_ARRAY_BUFFER = 34962
_ATTRIBUTES = {
    "normals": ("NORMAL", "<f4", {"componentType": _FLOAT, "type": "VEC3"}),
    "uvs": ("TEXCOORD_0", "<f4", {"componentType": _FLOAT, "type": "VEC2"}),
    "colors": ("_COLOR_0", "u1", {"componentType": _UNSIGNED_BYTE, "type": "VEC4", "normalized": True}),
}


def add_attributes(glb: GlbFile, look: Appearance) -> None:
    """Add the attributes of the vertices to the file and to each primitive."""
    document = glb.document
    for kind, values in look.row_arrays.items():
        name, dtype, form = _ATTRIBUTES[kind]
        view = glb.append_view(values.astype(dtype), target=_ARRAY_BUFFER)
        document["accessors"].append({"bufferView": view, "count": len(values), **form})
        for mesh in document["meshes"]:
            mesh["primitives"][0]["attributes"][name] = len(document["accessors"]) - 1


def name_groups(glb: GlbFile, look: Appearance, slices: Slices) -> None:
    """List in each node with faces the groups of the input that its faces are in."""
    if look.face_group is None:
        return
    for node in glb.document["nodes"]:
        if "mesh" in node:
            node["extras"]["groups"] = look.groups_of(slices[node["mesh"]])
