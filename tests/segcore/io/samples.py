"""One small mesh, two triangles in space, in every format."""

import struct

from gltf_files import FLOAT, Asset
from ply_files import ENCODINGS, Properties, Rows, ply
from soups import Point, Soup
from threemf_files import Model3MF

SQUARE = Soup([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.5)], [[0, 1, 2], [0, 2, 3]])

OFF = b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 .5\n3 0 1 2\n3 0 2 3\n"
OBJ = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\nf 1 2 3\nf 1 3 4\n"

XYZ: Properties = [("float", "x"), ("float", "y"), ("float", "z")]
INDICES: Properties = [("list", "uint8", "int", "vertex_indices")]
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


def gltf_square() -> Asset:
    asset = Asset()
    positions = asset.accessor(SQUARE.vertices, FLOAT)
    asset.add("meshes", {"primitives": [asset.primitive(positions, [0, 1, 2, 0, 2, 3])]})
    asset.root(mesh=0)
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
