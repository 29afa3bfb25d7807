"""Vertices that no face uses: no influence on results, and no number in any output that a reader would refuse."""

import io
import json
import struct
import warnings
import zipfile

import numpy as np
import pytest

from helpers.files.polygon_soups import read
from segcore.clean.surface import build_surface
from segcore.errors import InvalidMesh
from segcore.io import WRITERS, read_result
from segcore.io.mesh_writer import write_mesh
from segcore.io.picture import draw
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.report import mesh_report
from segcore.shapes import icosphere

BALL = icosphere(2)
STRAY = [[np.nan] * 3, [np.inf, 0, 0], [1e300, 0, 0], [1e99, -1e99, 1e60], [1e9, 0, 0], BALL.vertices[3].tolist()]
BEFORE, AFTER = 4, 2


def with_strays() -> Mesh:
    vertices = np.concatenate([STRAY[:BEFORE], BALL.vertices, STRAY[BEFORE:]])
    return Mesh(vertices, BALL.faces + BEFORE)


def test_the_surface_is_that_of_the_mesh_without_them() -> None:
    plain, strayed = build_surface(BALL), build_surface(with_strays())
    assert strayed.unit == plain.unit
    for name in ("vertices", "faces", "normals", "areas", "edge_faces", "edge_vertices", "face_of_input"):
        np.testing.assert_array_equal(getattr(strayed, name), getattr(plain, name))


def test_the_report_counts_them_and_measures_the_rest() -> None:
    plain, strayed = mesh_report(BALL), mesh_report(with_strays())
    assert strayed.unused_vertices == len(STRAY)
    assert strayed.vertices == plain.vertices + len(STRAY)
    for name in ("lower", "upper", "area", "volume", "welded_vertices", "border_edges", "components"):
        assert getattr(strayed, name) == getattr(plain, name)
    assert "3 vertices that no face uses" in strayed.notes[0]


def test_the_picture_shows_the_mesh_as_if_they_were_not_there() -> None:
    labels = np.zeros(len(BALL.faces), dtype=np.int32)
    np.testing.assert_array_equal(draw(with_strays(), labels, 64), draw(BALL, labels, 64))


@pytest.mark.parametrize("form", ["off", "ply", "obj", "stl"])
def test_written_meshes_read_back(form: str) -> None:
    target = io.BytesIO()
    mesh = with_strays()
    write_mesh(target, mesh, form)
    back = read(target.getvalue())
    if form == "stl":
        np.testing.assert_array_equal(back.corners, BALL.corners.astype(np.float32))
    else:
        np.testing.assert_array_equal(back.vertices, mesh.vertices)
        np.testing.assert_array_equal(back.faces, mesh.faces)


def test_the_segments_are_those_of_the_mesh_without_them_and_every_format_is_written() -> None:
    plain, strayed = segment(BALL), segment(with_strays())
    np.testing.assert_array_equal(strayed.labels(2), plain.labels(2))
    written = {name: io.BytesIO() for name in WRITERS}
    for name, target in written.items():
        WRITERS[name].write(target, with_strays(), strayed, 2)
    for name in ("glb", "ply", "obj"):
        np.testing.assert_allclose(mesh_report(read(written[name].getvalue())).area, mesh_report(BALL).area, rtol=1e-5)
    (size,) = struct.unpack_from("<I", written["glb"].getvalue(), 12)
    document = json.loads(written["glb"].getvalue()[20 : 20 + size], parse_constant=pytest.fail)
    bounds = [entry[key] for entry in document["accessors"] for key in ("min", "max") if key in entry]
    assert np.abs(np.concatenate([np.ravel(bound) for bound in bounds if len(bound) == 3])).max() <= 1
    json.loads(written["json"].getvalue(), parse_constant=pytest.fail)
    back = read_result(io.BytesIO(written["cleave"].getvalue()))
    np.testing.assert_array_equal(back.mesh.vertices, with_strays().vertices)


FILES = {
    "off": "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n{bad} 0 0\n3 0 1 2\n",
    "obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv {bad} 0 0\nf 1 2 3\n",
    "ply": "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n{bad} 0 0\n3 0 1 2\n",
}
MODEL = (
    '<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
    '<object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>'
    '<vertex x="{bad}" y="0" z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object>'
    '</resources><build><item objectid="1" transform="0 1 0 1 0 0 0 0 1 5 5 5"/></build></model>'
)


def glb(bad: float) -> bytes:
    numbers = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, bad, 0, 0) + struct.pack("<4H", 0, 1, 2, 0)
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "rotation": [0.6, 0, 0, 0.8], "translation": [1, 2, 3]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 8}],
        "buffers": [{"byteLength": len(numbers)}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(numbers), b"BIN\0") + numbers
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def threemf(bad: float) -> bytes:
    relationships = (
        '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r" '
        'Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
    )
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w") as archive:
        archive.writestr("_rels/.rels", relationships)
        archive.writestr("3D/3dmodel.model", MODEL.format(bad=bad))
    return target.getvalue()


@pytest.mark.parametrize(
    "word", ["-nan", "nan(ind)", "-nan(ind)", "-1.#IND", "1.#QNAN0", "1.#INF00", "-Infinity", "1e999"]
)
def test_numbers_that_are_not_finite_are_read_as_c_programs_print_them(word: str) -> None:
    assert len(read(FILES["ply"].format(bad=word).encode()).vertices) == 4
    with pytest.raises(InvalidMesh, match=r"Vertex 1 .* not finite"):
        read(FILES["ply"].format(bad=1).replace("\n1 0 0\n", f"\n{word} 0 0\n").encode())


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("form", [*FILES, "glb", "3mf"])
def test_every_format_is_read(form: str, bad: float) -> None:
    data = glb(bad) if form == "glb" else threemf(bad) if form == "3mf" else FILES[form].format(bad=bad).encode()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh = read(data)
    assert len(mesh.vertices) == 4
    assert mesh.vertices[3].tolist() == mesh.vertices[0].tolist()
    assert "vertex that no face uses" in mesh.notes[0]
