"""Normals, texture coordinates, colours and names of groups go from the input into the outputs, each to its corner."""

import io

import numpy as np
import pygltflib
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.gltf import FLOAT
from helpers.files.hierarchies import looks, two_strips
from helpers.files.ply import ENCODINGS, ply
from helpers.files.samples import DRESSED, INDICES, OBJ, OFF, SAMPLES, SQUARE, XYZ, gltf_square, gltf_with_attributes
from helpers.files.threemf import Model3MF
from helpers.files.written import written
from segcore.appearance import Appearance
from segcore.errors import InvalidMesh, UnsupportedFormat
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh
from segcore.io.result import read_result
from segcore.mesh import Mesh


def read_look(data: bytes) -> Appearance:
    look = read_mesh(io.BytesIO(data), appearance=True).appearance
    assert look is not None
    return look


def at_corners(mesh: Mesh) -> dict[str, list]:
    """What every corner of every face looks like."""
    look = mesh.appearance
    assert look is not None
    rows = mesh.faces if look.corners is None else look.corners
    return {name: values[rows].tolist() for name, values in look.row_arrays.items()}


@given(looks())
def test_a_result_file_keeps_everything(looking: tuple[Mesh, Hierarchy]) -> None:
    mesh, hierarchy = looking
    back = read_result(io.BytesIO(written("cleave", mesh, hierarchy))).mesh
    assert at_corners(back) == at_corners(mesh)
    assert back.appearance.extra_vertex.tolist() == mesh.appearance.extra_vertex.tolist()
    assert back.appearance.face_group.tolist() == mesh.appearance.face_group.tolist()
    assert back.appearance.group_names == mesh.appearance.group_names


@given(looks())
def test_obj_keeps_texture_coordinates_and_normals_of_corners(looking: tuple[Mesh, Hierarchy]) -> None:
    mesh, hierarchy = looking
    back = read_mesh(io.BytesIO(written("obj", mesh, hierarchy, 1)), appearance=True)
    ours, theirs = at_corners(mesh), at_corners(back)
    assert theirs["normals"] == ours["normals"]
    assert theirs["uvs"] == ours["uvs"]
    colors = mesh.appearance.colors[: len(mesh.vertices), :3]
    assert back.appearance.colors[: len(mesh.vertices), :3].tolist() == colors.tolist()
    assert back.vertices.tolist() == mesh.vertices.tolist()
    assert set(back.appearance.group_names) >= {"segment_0"}


@given(looks())
def test_ply_keeps_what_vertices_have(looking: tuple[Mesh, Hierarchy]) -> None:
    mesh, hierarchy = looking
    back = read_mesh(io.BytesIO(written("ply", mesh, hierarchy, 1)), appearance=True)
    if len(mesh.appearance.extra_vertex):
        assert back.appearance is None
    else:
        assert at_corners(back) == at_corners(mesh)


@given(looks(), st.booleans())
def test_glb_keeps_attributes_as_other_programs_read_them(looking: tuple[Mesh, Hierarchy], all_levels: bool) -> None:
    mesh, hierarchy = looking
    asset = pygltflib.GLTF2().load_from_bytes(written("glb", mesh, hierarchy, 2, all_levels=all_levels))
    attributes = {str(part.primitives[0].attributes.__dict__) for part in asset.meshes}
    assert len(attributes) == 1
    sources = asset.meshes[0].primitives[0].attributes
    named = {"normals": (sources.NORMAL, "<f4", 3), "uvs": (sources.TEXCOORD_0, "<f4", 2)}
    for name, (accessor, dtype, width) in (named | {"colors": (sources._COLOR_0, "u1", 4)}).items():
        entry = asset.accessors[accessor]
        view = asset.bufferViews[entry.bufferView]
        values = np.frombuffer(asset.binary_blob(), dtype, width * entry.count, view.byteOffset).reshape(-1, width)
        assert values.tolist() == getattr(mesh.appearance, name).tolist()
        assert entry.count == asset.accessors[sources.POSITION].count
    groups = [set(node.extras["groups"]) for node in asset.nodes if node.mesh is not None]
    assert set().union(*groups) == set(mesh.appearance.group_names)


@given(looks())
def test_glb_goes_round(looking: tuple[Mesh, Hierarchy]) -> None:
    mesh, hierarchy = looking
    back = read_mesh(io.BytesIO(written("glb", mesh, hierarchy, 1)), appearance=True)
    ours, theirs = at_corners(mesh), at_corners(back)
    assert (theirs["normals"], theirs["uvs"]) == (ours["normals"], ours["uvs"])
    assert back.corners.tolist() == mesh.corners.tolist()


@pytest.mark.parametrize(
    "data", [data for group in (SAMPLES, DRESSED) for samples in group.values() for data in samples]
)
def test_the_appearance_changes_neither_vertices_nor_faces(data: bytes) -> None:
    plain, kept = read_mesh(io.BytesIO(data)), read_mesh(io.BytesIO(data), appearance=True)
    assert plain.appearance is None
    assert kept.vertices.tolist() == plain.vertices.tolist()
    assert kept.faces.tolist() == plain.faces.tolist()


@pytest.mark.parametrize(("name", "data"), [(name, data) for name, samples in DRESSED.items() for data in samples])
def test_what_a_format_can_say_beside_the_shape_is_read(name: str, data: bytes) -> None:
    look = read_look(data)
    vertices = {"off", "ply", "obj", "glb", "gltf"}
    groups = {"stl", "obj", "glb", "gltf", "3mf"}
    assert (look.normals is not None) == (name in vertices)
    assert (look.face_group is not None) == (name in groups)


def test_off_with_all_prefixes() -> None:
    rows = ["0 0 0  0 0 2  255 0 0 128  0 1", "1 0 0  0 3 0  0 255 0 255  .5 .25", "0 1 0  1 0 0  1 2 3 4  1 1"]
    look = read_look(("STCNOFF 3 1 0\n" + "\n".join(rows) + "\n3 0 1 2\n").encode())
    assert look.normals.tolist() == [[0, 0, 1], [0, 1, 0], [1, 0, 0]]
    assert look.colors.tolist() == [[255, 0, 0, 128], [0, 255, 0, 255], [1, 2, 3, 4]]
    assert look.uvs.tolist() == [[0, 1], [0.5, 0.25], [1, 1]]


@pytest.mark.parametrize(("colors", "expected"), [("1 0 .2", [255, 0, 51, 255]), ("51 0 255", [51, 0, 255, 255])])
def test_off_with_colours_of_three_numbers(colors: str, expected: list[int]) -> None:
    data = f"COFF\n3 1 0\n0 0 0 {colors}\n1 0 0 {colors}\n0 1 0 {colors}\n3 0 1 2\n".encode()
    assert read_look(data).colors.tolist() == [expected] * 3


@pytest.mark.parametrize(("kind", "value", "expected"), [("uint8", 51, 51), ("uint16", 13107, 51), ("float", 0.2, 51)])
def test_ply_colours_of_any_type(kind: str, value: float, expected: int) -> None:
    columns = [*XYZ, (kind, "red"), (kind, "green"), (kind, "blue")]
    top = {"uint8": 255, "uint16": 65535, "float": 1.0}[kind]
    rows = [[*vertex, value, 0, top] for vertex in SQUARE.vertices]
    data = ply("binary_big_endian", [("vertex", columns, rows), ("face", INDICES, [[[0, 1, 2]]])])
    assert read_look(data).colors.tolist() == [[expected, 0, 255, 255]] * 4


def test_groups_and_objects_of_obj_name_the_faces_after_them() -> None:
    vertices = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    text = vertices + b"f 1 2 3\ng  wheel  left\nf 1 2 3 4\no axle\nf 2 3 4\ng wheel  left\nf 1 2 4\n"
    look = read_look(text)
    assert [look.group_names[group] for group in look.face_group] == ["", *["wheel  left"] * 2, "axle", "wheel  left"]


@pytest.mark.parametrize(
    "faces",
    [
        b"f 1/1/1 2/2/1 3/1\n", b"f 1/9/9 2/1/1 3/1/1\n", b"f 1/1 2/2/1 3\n", b"f 1//1 2/2 3/1/1\n",
        b"f 1/-9 2/1 3/1\n",
    ],
)  # fmt: skip
def test_corners_of_obj_that_make_no_sense_are_left_out(faces: bytes) -> None:
    data = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\n" + faces
    mesh = read_mesh(io.BytesIO(data), appearance=True)
    assert mesh.faces.tolist() == [[0, 1, 2]]
    assert mesh.appearance is None or mesh.appearance.normals is None or mesh.appearance.uvs is None


corner_numbers = st.tuples(st.integers(1, 4), st.sampled_from([*range(-3, 5)]), st.sampled_from([*range(-3, 5)]))


@given(st.lists(st.lists(corner_numbers, min_size=3, max_size=4), min_size=1, max_size=5))
def test_corners_of_obj_pick_what_they_say(polygons: list[list[tuple[int, int, int]]]) -> None:
    """Four vertices, three texture coordinates, of which the last comes before the last face, and three normals."""
    form = {(True, True): "{}/{}/{}", (True, False): "{}/{}", (False, True): "{0}//{2}", (False, False): "{}"}
    lines = ["f " + " ".join(form[bool(t), bool(n)].format(v, t, n) for v, t, n in corners) for corners in polygons]
    tables = {"vt": [[0.5, 0.25], [0.75, 0.5], [1, 0]], "vn": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}
    text = [f"v {x} {y} 0" for x in (0, 1) for y in (0, 1)]
    text += [f"{key} {' '.join(map(str, row))}" for key, rows in tables.items() for row in rows]
    last = text.index("vt 1 0")
    mesh = read_mesh(
        io.BytesIO("\n".join([*text[:last], *text[last + 1 :], *lines[:-1], text[last], lines[-1], ""]).encode()),
        appearance=True,
    )
    for name, key, place in (("uvs", "vt", 1), ("normals", "vn", 2)):
        known = [2 if key == "vt" and p < len(polygons) - 1 else 3 for p in range(len(polygons))]
        rows = [
            [c[place] + (known[p] if c[place] < 0 else -1 if c[place] else -9) for c in corners]
            for p, corners in enumerate(polygons)
        ]
        found = None if mesh.appearance is None else getattr(mesh.appearance, name)
        if not all(0 <= row < 3 for corners in rows for row in corners):
            assert found is None
            continue
        expected = [
            [tables[key][rows[p][i]] for i in (0, k, k + 1)]
            for p, corners in enumerate(polygons)
            for k in range(1, len(corners) - 1)
        ]
        ours = np.array(at_corners(mesh)[name])
        np.testing.assert_allclose([0, 1] + ours * [1, -1] if name == "uvs" else ours, expected, atol=1e-6)


def test_negative_indices_of_obj_count_back_from_their_line() -> None:
    data = (
        b"v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt .5 1\nvn 0 0 1\nvn 0 1 0\nf -3/-2/-2 -2/-1/-2 -1/-2/-1\n"
        b"vt 1 1\nvn 1 0 0\nf -3/-1/-1 -2/-1/-1 -1/-1/-1\n"
    )
    mesh = read_mesh(io.BytesIO(data), appearance=True)
    corners = at_corners(mesh)
    assert corners["uvs"] == [[[0, 1], [0.5, 0], [0, 1]], [[1, 0]] * 3]
    assert corners["normals"] == [[[0, 0, 1], [0, 0, 1], [0, 1, 0]], [[1, 0, 0]] * 3]


def test_solids_of_stl_and_objects_of_3mf_and_nodes_of_gltf_are_groups() -> None:
    facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
    stl = f"solid Left Wheel\n{facet}{facet}endsolid\nsolid axle\n{facet}endsolid axle\n".encode()
    model = Model3MF()
    model.item(model.mesh(SQUARE, "Left Wheel"))
    model.item(model.mesh(SQUARE, "axle"))
    asset = gltf_square()
    asset.document["nodes"][0]["name"] = "Left Wheel"
    asset.document["meshes"][0]["name"] = "axle"
    asset.root(mesh=0)
    for data in (stl, model.package(), asset.glb()):
        look = read_look(data)
        assert look.group_names == ("Left Wheel", "axle")
        assert look.face_group.tolist()[0] == 0
        assert look.face_group.tolist()[-1] == 1


def test_gltf_normals_turn_with_their_nodes_and_colours_become_srgb() -> None:
    asset = gltf_with_attributes()
    asset.root(mesh=0, scale=[1, 2, 1])
    asset.root(mesh=0, scale=[1, 1, -1])
    look = read_look(asset.glb())
    first, mirrored = np.array([0, 0.3, 0.8]), np.array([0, 0.6, -0.8])
    np.testing.assert_allclose(look.normals[:4], [first / np.linalg.norm(first)] * 4, atol=1e-6)
    np.testing.assert_allclose(look.normals[4:], [mirrored] * 4, atol=1e-6)
    assert look.uvs.tolist() == [[0.25, 0.5]] * 8
    assert look.colors.tolist() == [[255, 0, 128, 128]] * 8  # 55 / 255 of the light is half of sRGB


def test_an_attribute_that_only_some_primitives_have_is_left_out() -> None:
    asset = gltf_with_attributes()
    asset.root(mesh=0)
    bare = asset.primitive(asset.accessor(SQUARE.vertices, FLOAT), [0, 1, 2])
    bare["attributes"]["NORMAL"] = 2
    asset.document["meshes"][0]["primitives"].append(bare)
    mesh = read_mesh(io.BytesIO(asset.glb()), appearance=True)
    assert mesh.appearance.uvs is mesh.appearance.colors is None
    assert len(mesh.faces) == 3


@pytest.mark.parametrize("accessor", [-1, -100, 10**6])
def test_an_attribute_in_an_accessor_that_is_not_there_is_left_out(accessor: int) -> None:
    asset = gltf_with_attributes()
    asset.root(mesh=0)
    asset.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = accessor
    mesh = read_mesh(io.BytesIO(asset.glb()), appearance=True)
    assert mesh.appearance.uvs is None
    assert mesh.appearance.normals is not None


def test_normals_without_direction_are_left_out() -> None:
    assert read_mesh(io.BytesIO(OBJ), appearance=True).appearance is None
    data = OFF.replace(b"OFF", b"NOFF").replace(b"0 0 0\n", b"0 0 0 0 0 0\n").replace(b"1 0 0\n", b"1 0 0 0 0 1\n")
    data = data.replace(b"1 1 0\n", b"1 1 0 0 0 1\n").replace(b"0 1 .5\n", b"0 1 .5 0 0 1\n")
    assert read_mesh(io.BytesIO(data), appearance=True).appearance is None


@pytest.mark.parametrize(
    "data",
    [
        b"OFF\n0 1 0\n3 0 1 2\n", b"STCNOFF\n0 1 0\n3 0 1 2\n", b"vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n",
        *(ply(name, [("vertex", XYZ, []), ("face", INDICES, [[[0, 1, 2]]])]) for name in ENCODINGS),
    ],
)  # fmt: skip
def test_a_file_without_vertices_is_refused_whatever_is_kept_of_it(data: bytes) -> None:
    for appearance in (False, True):
        with pytest.raises((InvalidMesh, UnsupportedFormat)):
            read_mesh(io.BytesIO(data), appearance=appearance)


def test_an_appearance_of_another_mesh_is_refused() -> None:
    mesh, _ = two_strips()
    for look in (
        Appearance(normals=np.eye(3, dtype=np.float32)),
        Appearance(face_group=np.zeros(3, np.int32), group_names=("a",)),
        Appearance(uvs=np.zeros((11, 2), np.float32), extra_vertex=np.array([99], np.int32), corners=mesh.faces),
    ):
        with pytest.raises(InvalidMesh, match="another mesh"):
            Mesh(mesh.vertices, mesh.faces, None, look)
    with pytest.raises(InvalidMesh, match="list of names"):
        Appearance(face_group=np.array([1], np.int32), group_names=("a",))
    with pytest.raises(InvalidMesh, match="columns"):
        Appearance(normals=np.zeros((10, 2), np.float32))
