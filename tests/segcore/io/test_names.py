"""Names of segments in every format that can have them."""

import io
import json
import re
import struct
import xml.etree.ElementTree as ET

import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.hierarchies import two_strips
from helpers.files.polygon_soups import read
from helpers.files.written import members, written
from segcore.io import read_mesh
from segcore.io.names import file_stems, group_names, identifiers, segment_names
from segcore.mesh import Mesh

names = st.dictionaries(st.integers(0, 9), st.text(max_size=80), max_size=8)


def test_a_segment_without_a_name_is_called_by_its_label() -> None:
    assert segment_names(None, 3) == ["segment 0", "segment 1", "segment 2"]
    assert segment_names({1: "wheel", 7: "not here"}, 3) == ["segment 0", "wheel", "segment 2"]
    assert group_names({1: " left\twheel #2\\"}, 2) == ["segment_0", "left_wheel_2"]
    assert file_stems({1: "../a/ wheel: größe?"}, 12)[:2] == ["segment_00", "segment_01_a_wheel_größe"]
    assert segment_names({0: "segment 1", 2: "\n\x7f"}, 3) == ["segment 1", "segment 1 1", "segment 2"]


@given(names, st.integers(1, 8))
def test_no_two_names_are_alike_and_none_breaks_its_file(given_names: dict[int, str], count: int) -> None:
    for make in (segment_names, group_names, file_stems):
        made = make(given_names, count)
        assert len({name.casefold() for name in made}) == len(made) == count
        assert all(name.isprintable() and 0 < len(name.encode()) < 255 for name in made)
    assert not any(re.search(r"[\s#\\]", name) for name in group_names(given_names, count))
    stems = file_stems(given_names, count)
    assert stems == sorted(stems)
    assert all(re.fullmatch(r"segment_\d+(_\w+)?", stem) for stem in stems)


@given(names)
def test_every_writer_takes_any_names_and_moves_no_label(given_names: dict[int, str]) -> None:
    mesh, hierarchy = two_strips()
    labels = hierarchy.labels(3)
    for kind in ("obj", "3mf", "glb"):
        options = {"capped": False} if kind == "3mf" else {}
        back = read_mesh(io.BytesIO(written(kind, mesh, hierarchy, 3, names=given_names, **options)), appearance=True)
        expected = (group_names if kind == "obj" else segment_names)(given_names, 3)
        assert set(back.appearance.group_names) == set(expected)
        of_group = {
            name: back.corners[back.appearance.face_group == i] for i, name in enumerate(back.appearance.group_names)
        }
        for label, name in enumerate(expected):
            assert of_group[name].tolist() == mesh.corners[labels == label].tolist()
    assert read(written("ply", mesh, hierarchy, 3, names=given_names)).corners.tolist() == mesh.corners.tolist()
    for part_format in ("stl", "obj"):
        files = members(written("zip", mesh, hierarchy, 3, names=given_names, part_format=part_format))
        assert list(files)[:-1] == [f"{stem}.{part_format}" for stem in file_stems(given_names, 3)]
        assert [part["name"] for part in json.loads(files["parts.json"])["parts"]] == segment_names(given_names, 3)


def test_other_programs_find_the_names() -> None:
    mesh, hierarchy = two_strips()
    called = {0: "left & <right>", 2: "rad größe"}
    scene = trimesh.load(io.BytesIO(written("3mf", mesh, hierarchy, 3, names=called)), file_type="3mf")
    assert set(scene.geometry) == {"left & <right>", "segment 1", "rad größe"}
    data = written("glb", mesh, hierarchy, 3, names=called)
    (length,) = struct.unpack_from("<I", data, 12)
    assert data[20 : 20 + length].isascii()
    assert set(trimesh.load(io.BytesIO(data), file_type="glb").geometry) == set(scene.geometry)
    assert b"\no left_&_<right>\n" in written("obj", mesh, hierarchy, 3, names=called)
    header = written("ply", mesh, hierarchy, 3, names=called).partition(b"end_header")[0].decode("ascii")
    assert re.findall("comment label .*", header) == [
        "comment label 0 is left & <right>",
        r"comment label 2 is rad gr\xf6\xdfe",
    ]


@pytest.mark.parametrize("kind", ["obj", "3mf"])
def test_groups_of_the_input_are_noted(kind: str) -> None:
    data = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng a <wheel>\nf 1 2 3\ng axle\\wide\nf 1 3 4\n"
    look = read_mesh(io.BytesIO(data), appearance=True).appearance
    mesh, hierarchy = two_strips()
    of_faces = look.face_group[[0, 1, 0, 1]]
    dressed = Mesh(mesh.vertices, mesh.faces, None, type(look)(face_group=of_faces, group_names=look.group_names))
    out = written(kind, dressed, hierarchy, 3, **({"capped": False} if kind == "3mf" else {}))
    assert read(out).corners.shape == mesh.corners.shape
    notes = {label: {look.group_names[g] for g in of_faces[hierarchy.labels(3) == label]} for label in range(3)}
    if kind == "obj":
        groups = re.split(rb"\no segment_\d+\nusemtl segment_\d+\n", out)[1:]
        found = [re.findall(r"# group of the input: (.*)\n", group.decode()) for group in groups]
        assert [set(names) for names in found] == [{n.replace("\\", "/") for n in notes[k]} for k in range(3)]
    else:
        (model,) = (ET.fromstring(text) for name, text in members(out).items() if name.endswith(".model"))
        space = {"m": "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"}
        found = [entry.text for entry in model.iterfind(".//m:object/m:metadatagroup/m:metadata", space)]
        assert [set(text.removeprefix("groups of the input: ").split(", ")) for text in found] == list(notes.values())


@given(st.lists(st.text(max_size=8)))
def test_identifiers_are_valid_and_differ_ignoring_case(names: list[str]) -> None:
    found = identifiers(names, ("World", "a"))
    assert all(re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", word) for word in found)
    assert len({"world", "a", *(word.lower() for word in found)}) == len(names) + 2


def test_identifiers_keep_what_is_valid() -> None:
    names = ["left arm", "left_arm", "9 lives", "車", "a"]
    assert identifiers(names, ["A"]) == ["left_arm", "left_arm_2", "_9_lives", "segment_3", "a_2"]
