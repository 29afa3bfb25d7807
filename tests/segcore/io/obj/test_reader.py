"""The OBJ reader: every face in its place in any layout of the file, no file half read."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.damage import assert_agrees, assert_never_half_read, damaged
from helpers.files.plain_readers import slow_obj
from helpers.files.polygon_soups import Soup, assert_is_soup, read, soups
from helpers.files.samples import OBJ as SQUARE
from helpers.files.samples import SQUARE as SOUP
from segcore.errors import InvalidMesh, LimitExceeded
from segcore.io import ReadLimits

FULL = (
    b"# Exported \\\nmtllib ../../etc/passwd\no part 1\ng front f v\nusemtl red#1\ns off\n"
    b"v 0 0 0 1 0 0\nv\t1 0\t0 1.0\nvt 0 0\nvn 0 0 1\nv 1 1 0\nv .5 \\\n 1 -1e-1\n"
    b"f 1/1/1 2//1 \\\n3/1\nl 1 2\nf -4 -2 -1 # last\nv 0 0 9\np 1\nf 1/ 2/2/3 -1/-1 4\n"
)
line_ends = st.sampled_from(["\n", "\r\n", "\n\n", " \t\n", "\n# v 1 2 3\n", " # 7\n", "\nvt 0.5 0.5\n", "\ng a b\n"])
gaps = st.sampled_from([" ", "  ", "\t", " \\\n", " \\\r\n\t"])
vertex_tails = st.sampled_from(["", " 1.0", " 0.5 0.5 0.5", " 1 0.5 0.5 0.5"])
corner_tails = st.sampled_from(["", "/1", "//2", "/1/2", "/-1/-1", "/"])


@st.composite
def obj_files(draw: st.DrawFn, soup: Soup) -> bytes:
    """The soup with its statements in any valid order, and other statements between them."""
    lines = [f"v{draw(gaps)}{' '.join(map(repr, vertex))}{draw(vertex_tails)}" for vertex in soup.vertices]
    for polygon in soup.polygons:
        line = "f"
        position = draw(st.integers(0, len(lines)))  # the first line at which the face may be inserted
        position = max(position, 1 + max((i for i, text in enumerate(lines) if text[0] == "f"), default=-1))
        before = sum(text[0] == "v" for text in lines[:position])
        for corner in polygon:
            relative = draw(st.booleans()) and corner < before
            line += f"{draw(gaps)}{corner - before if relative else corner + 1}{draw(corner_tails)}"
        lines.insert(position, line)
    return "".join(line + draw(line_ends) for line in lines).encode()


@given(data=st.data(), soup=soups())
def test_every_vertex_and_face_keeps_its_place_in_any_layout(data: st.DataObject, soup: Soup) -> None:
    file = data.draw(obj_files(soup))
    assert_is_soup(read(file, "obj"), soup)
    assert slow_obj(file) == (soup.vertices, soup.triangles)


@given(damaged([SQUARE, FULL], b" \n\r\t#/0123456789.-+evf\\\0\xff"))
def test_a_damaged_file_is_read_as_it_stands_or_refused(data: bytes) -> None:
    assert_agrees(data, "obj", slow_obj)


def test_a_file_cut_within_its_faces_is_never_read_with_a_broken_face() -> None:
    """An OBJ file does not specify its length, so that a cut between two lines cannot be detected."""
    for length in range(len(SQUARE)):
        if not SQUARE[:length].endswith((b"f 1 2 3", b"f 1 2 3\n", b"f 1 3 4")):
            with pytest.raises(InvalidMesh):
                read(SQUARE[:length], "obj")


def test_one_face_is_never_half_read() -> None:
    assert_never_half_read(SQUARE.replace(b"f 1 3 4\n", b""), Soup(SOUP.vertices, SOUP.polygons[:1]), "obj")


@pytest.mark.parametrize(
    "data",
    [
        SQUARE[:-1],
        SQUARE.replace(b"\n", b"\r"),
        SQUARE.replace(b" ", b"\t"),
        b"\xef\xbb\xbf" + SQUARE,
        b"# \xe9\n" + SQUARE,
    ],
    ids=["no end of line", "CR", "tabs", "BOM", "Latin-1"],
)
def test_usual_variants_are_read(data: bytes) -> None:
    assert_is_soup(read(data), SOUP)


def test_faces_with_fewer_than_three_corners_are_left_out_and_noted() -> None:
    mesh = read(SQUARE.replace(b"f 1 3 4", b"f 1 2\nf\nf 1 3 4\nf 4/1"), appearance=True)
    assert mesh.faces.tolist() == SOUP.polygons
    assert mesh.source_polygon.tolist() == [0, 3]
    assert mesh.notes == ("3 faces of the file with fewer than three corners are left out.",)
    assert read(SQUARE.replace(b"f 1 3 4", b"f 1")).notes == (
        "1 face of the file with fewer than three corners is left out.",
    )


def test_everything_but_vertices_and_faces_is_passed_over() -> None:
    mesh = read(FULL)
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0.5, 1, -0.1], [0, 0, 9]]
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4], [0, 4, 3]]
    assert mesh.source_polygon is not None
    assert mesh.source_polygon.tolist() == [0, 1, 2, 2]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"f 1 3 4", b"f 0 3 4", "Line 6: there is no vertex 0"),
        (b"f 1 3 4", b"f 1 3 5", "Line 6: there is no vertex 5"),
        (b"f 1 3 4", b"f 1 3 -5", "Line 6: there is no vertex -5"),
        (b"f 1 3 4\n", b"f 1 3", "Line 6: a face needs"),
        (b"f 1 3 4", b"f 1 3 4.5", "Line 6: '4.5' is not a vertex index"),
        (b"f 1 3 4", b"f 1/x 3 4", "Line 6: '1/x'"),
        (b"f 1 3 4", b"f /1 3 4", "Line 6: '/1' is not a vertex index"),
        (b"f 1 3 4", b"f 1 3 4f", "Line 6: '4f'"),
        (b"v 0 1 .5", b"v 0 1", "Line 4: a vertex needs"),
        (b"v 0 1 .5", b"v 0 v1 0", "Line 4: 'v1'"),
        (b"v 0 1 .5", b"v 0 inf 0", "not finite"),
        (b"v 0 1 .5", b"v 0 1e999 0", "not finite"),
        (b"f 1 2 3\nf 1 3 4\n", b"", "no faces"),
    ],
)
def test_a_wrong_file_is_refused_with_the_line(old: bytes, new: bytes, message: str) -> None:
    with pytest.raises(InvalidMesh, match=message):
        read(SQUARE.replace(old, new))


def test_counts_beyond_the_limits_are_refused_by_name() -> None:
    for limits, name in ((ReadLimits(max_faces=1), "max_faces = 1"), (ReadLimits(max_vertices=3), "max_vertices = 3")):
        with pytest.raises(LimitExceeded, match=name):
            read(SQUARE, limits=limits)


@pytest.mark.parametrize(
    "line",
    [
        b"g \x95\\",  # Shift-JIS for one letter
        b"o a\\",
        b"usemtl a\\",
        b"mtllib textures\\",
        b"mtllib textures\\ ",
        b"s off\\",
        b"# a comment\\",
        b"g a # a comment\\",
        b"\tg a\\\ng b\\",
        b"unknown\\",
    ],
)
@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_a_name_a_path_or_a_comment_may_end_in_a_backslash(line: bytes, end: bytes) -> None:
    for place in range(7):
        lines = SQUARE.splitlines()
        lines.insert(place, line.replace(b"\n", end))
        assert_is_soup(read(end.join(lines), "obj"), SOUP)


def test_a_line_of_numbers_continues_over_any_number_of_lines() -> None:
    data = SQUARE.replace(b"v 1 1 0", b" v 1 \\\n 1 \\\n \\\r\n 0").replace(b"f 1 3 4", b"f\t\\\n1 \\\n3 4\ng a\\")
    assert_is_soup(read(data), SOUP)
    assert_is_soup(read(data.replace(b"\r", b"").replace(b"\n", b"\r")), SOUP)


@pytest.mark.parametrize(
    "ends", [(b"\r", b"\n"), (b"\r\n", b"\r"), (b"\n", b"\r"), (b"\r\r\n", b"\n"), (b"\n\r", b"\r")]
)
def test_line_ends_of_several_kinds_in_one_file_are_read(ends: tuple[bytes, bytes]) -> None:
    for place in range(7):
        lines = [line + (ends[1] if i == place else ends[0]) for i, line in enumerate([b"# a", *SQUARE.splitlines()])]
        assert_is_soup(read(b"".join(lines), "obj"), SOUP)
