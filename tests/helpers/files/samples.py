"""One small mesh, two triangles in space, in every format."""

import json
import struct

from helpers.files.gltf import FLOAT, Asset
from helpers.files.ply import ENCODINGS, Properties, Rows, ply
from helpers.files.polygon_soups import Point, Soup
from helpers.files.threemf import Model3MF

SQUARE = Soup([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.5)], [[0, 1, 2], [0, 2, 3]])

OFF = b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 .5\n3 0 1 2\n3 0 2 3\n"
OBJ = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\nf 1 2 3\nf 1 3 4\n"

XYZ: Properties = [("float", "x"), ("float", "y"), ("float", "z")]
INDICES: Properties = [("list", "uint8", "int", "vertex_indices")]
RGB = ("red", "green", "blue")
PLY_CORNERS: Rows = [list(vertex) for vertex in SQUARE.vertices]
PLY_FACES: Rows = [[[*polygon]] for polygon in SQUARE.polygons]
PLY = {name: ply(name, [("vertex", XYZ, PLY_CORNERS), ("face", INDICES, PLY_FACES)]) for name in ENCODINGS}

ASCII_STL = (
    b"solid a facet of it\n"
    b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
    b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 .5\nendloop\nendfacet\n"
    b"endsolid a facet of it\n"
)


def unshared(soup: Soup) -> Soup:
    """A soup as STL has it: no vertex is shared by two polygons."""
    vertices = [soup.vertices[corner] for polygon in soup.polygons for corner in polygon]
    corners = iter(range(len(vertices)))
    return Soup(vertices, [[next(corners) for _ in polygon] for polygon in soup.polygons])


def binary_stl(triangles: list[tuple[Point, ...]], header: bytes = b"") -> bytes:
    faces = b"".join(struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0xABCD) for a, b, c in triangles)
    return header.ljust(80, b" ") + struct.pack("<I", len(triangles)) + faces


UNSHARED_SQUARE = unshared(SQUARE)
TRIANGLES = [tuple(SQUARE.vertices[corner] for corner in polygon) for polygon in SQUARE.polygons]
BINARY_STL = binary_stl(TRIANGLES)

# An OBJ file of two shells in two groups, of one material.
TWO_SQUARES = (
    "".join(f"v {x} {y} 0\n" for x in (0, 1, 2, 3) for y in (0, 1))
    + "usemtl red\ng left\nf 1 2 4 3\ng right\nf 5 6 8 7\n"
)


def gltf_square() -> Asset:
    asset = Asset()
    positions = asset.accessor(SQUARE.vertices, FLOAT)
    asset.add("meshes", {"primitives": [asset.primitive(positions, [0, 1, 2, 0, 2, 3])]})
    asset.root(mesh=0)
    return asset


def gltf_with_buffer(uri: str) -> tuple[bytes, bytes]:
    """A glTF file of two faces whose buffer is another file, and that buffer."""
    asset = gltf_square()
    asset.document["buffers"] = [{"byteLength": len(asset.binary), "uri": uri}]
    return json.dumps(asset.document).encode(), asset.binary


def gltf_with_attributes() -> Asset:
    asset = Asset()
    positions = asset.accessor(SQUARE.vertices, FLOAT)
    primitive = asset.primitive(positions, [0, 1, 2, 0, 2, 3])
    primitive["attributes"]["NORMAL"] = asset.accessor([(0.0, 0.6, 0.8)] * 4, FLOAT)
    view = asset.view([(0.25, 0.5)] * 4, FLOAT)
    uvs = {"bufferView": view, "componentType": FLOAT, "count": 4, "type": "VEC2"}
    primitive["attributes"]["TEXCOORD_0"] = asset.add("accessors", uvs)
    view = asset.view([(255, 0, 55, 128)] * 4, 5121)
    colors = {"bufferView": view, "componentType": 5121, "count": 4, "type": "VEC4", "normalized": True}
    primitive["attributes"]["COLOR_0"] = asset.add("accessors", colors)
    asset.add("meshes", {"primitives": [primitive]})
    return asset


def threemf_square() -> bytes:
    model = Model3MF()
    model.item(model.mesh(SQUARE))
    return model.package()


THREEMF_SQUARE = threemf_square()

SAMPLES = {
    "off": [OFF, b"\n# made by hand\n" + OFF, b"\xef\xbb\xbf" + OFF],
    "stl": [ASCII_STL, BINARY_STL, BINARY_STL + b"tail", b"solid" + BINARY_STL[5:]],
    "ply": list(PLY.values()),
    "obj": [OBJ, b"# OFF\n\n" + OBJ, b"mtllib x.mtl\ng a\n" + OBJ],
    "glb": [gltf_square().glb()],
    "gltf": [gltf_square().gltf(), b"\n " + gltf_square().gltf()],
    "3mf": [THREEMF_SQUARE],
}

_LOOK: Properties = [*XYZ, *(("float", name) for name in ("nx", "ny", "nz", "s", "t")), *(("uint8", c) for c in RGB)]
_LOOKS: Rows = [[*vertex, 0.0, 0.6, 0.8, 0.25, 0.5, 255, 0, 55] for vertex in SQUARE.vertices]


def named_square() -> bytes:
    model = Model3MF()
    model.item(model.mesh(SQUARE, "wheel"))
    return model.package()


def _dressed_gltf() -> Asset:
    asset = gltf_with_attributes()
    asset.root(mesh=0, scale=[1, 2, -1], name="wheel")
    return asset


DRESSED = {
    "off": [
        b"STCNOFF 4 2 0\n"
        + b"".join(b"%d %d 0 0 0 2 255 0 0 128 .5 1\n" % at for at in ((0, 0), (1, 0), (1, 1), (0, 1)))
        + b"3 0 1 2\n3 0 2 3\n"
    ],
    "stl": [ASCII_STL, ASCII_STL + ASCII_STL.replace(b"a facet of it", b"axle")],
    "ply": [ply(name, [("vertex", _LOOK, _LOOKS), ("face", INDICES, PLY_FACES)]) for name in ENCODINGS],
    "obj": [
        b"v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 .5 1 1 1\nvt 0 0\nvt 1 .5\nvn 0 0 1\nvn 0 .6 .8\n"
        b"g wheel\nf 1/1/1 2/2/1 3/1/2\no axle\nf -4/-2/-1 -2/-1/-1 -1/-1/-2\n",
        b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\nvn 0 0 1\ng a b\nf 1//1 2//1 3//1\nf 1//-1 3//-1 4//-1\n",
    ],
    "glb": [_dressed_gltf().glb()],
    "gltf": [_dressed_gltf().gltf()],
    "3mf": [named_square()],
}
"""The same with the normals, texture coordinates, colours and names of groups that the format can have."""
