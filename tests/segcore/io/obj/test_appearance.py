"""The appearance of OBJ files: attributes of corners, colours of vertices and names of groups."""

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.appearances import at_corners, looks, read_look
from helpers.files.written import written
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh
from segcore.mesh import Mesh


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
def test_invalid_attributes_of_corners_of_obj_are_left_out(faces: bytes) -> None:
    data = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\n" + faces
    mesh = read_mesh(io.BytesIO(data), appearance=True)
    assert mesh.faces.tolist() == [[0, 1, 2]]
    assert mesh.appearance is None or mesh.appearance.normals is None or mesh.appearance.uvs is None


corner_numbers = st.tuples(st.integers(1, 4), st.sampled_from([*range(-3, 5)]), st.sampled_from([*range(-3, 5)]))


@given(st.lists(st.lists(corner_numbers, min_size=3, max_size=4), min_size=1, max_size=5))
def test_corners_of_obj_have_the_attributes_of_their_indices(polygons: list[list[tuple[int, int, int]]]) -> None:
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
