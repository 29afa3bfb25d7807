"""The STL reader, for text and binary: every face in its place, no file half read."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.damage import assert_agrees, assert_never_half_read, damaged
from helpers.files.plain_readers import slow_ascii_stl, slow_binary_stl
from helpers.files.polygon_soups import Soup, assert_is_soup, read, soups, triangle_soups
from helpers.files.samples import ASCII_STL as ASCII
from helpers.files.samples import BINARY_STL as BINARY
from helpers.files.samples import TRIANGLES, unshared
from helpers.files.samples import UNSHARED_SQUARE as SOUP
from helpers.files.samples import binary_stl as binary
from segcore.errors import InvalidMesh, LimitExceeded
from segcore.io import ReadLimits

line_ends = st.sampled_from(["\n", "\r\n", "\n\n", " \t\n"])
gaps = st.sampled_from([" ", "  ", "\t", "\n", "\r\n\t"])


@st.composite
def ascii_files(draw: st.DrawFn, soup: Soup, gap: st.SearchStrategy[str]) -> bytes:
    name = draw(st.sampled_from(["", " x", " facet normal 0 0 1 outer loop", " solid endsolid"]))
    lines = [f"solid{name}"]
    for polygon in soup.polygons:
        corners = (soup.vertices[corner] for corner in polygon)
        statements = [
            "facet normal 0 0 1",
            "outer loop",
            *("vertex " + " ".join(map(repr, corner)) for corner in corners),
        ]
        lines += [*statements, "endloop", "endfacet"]
        if draw(st.integers(0, 9)) == 0:
            lines += [f"endsolid{name}", f"solid{name}"]
    lines.append(f"endsolid{name}")
    if draw(st.booleans()):
        lines = [line.upper() for line in lines]
    spaced = (line if "solid" in line.lower() else line.replace(" ", draw(gap)) for line in lines)
    return "".join(draw(st.sampled_from(["", "  "])) + line + draw(line_ends) for line in spaced).encode()


@given(data=st.data(), soup=triangle_soups().map(unshared), gap=st.sampled_from([gaps, st.just(" ")]))
def test_every_face_of_a_text_keeps_its_place(data: st.DataObject, soup: Soup, gap: st.SearchStrategy[str]) -> None:
    file = data.draw(ascii_files(soup, gap))
    assert_is_soup(read(file), soup)
    assert slow_ascii_stl(file) == (soup.vertices, soup.triangles)


@given(data=st.data(), soup=soups().map(unshared))
def test_loops_of_any_length_are_cut_into_fans(data: st.DataObject, soup: Soup) -> None:
    assert_is_soup(read(data.draw(ascii_files(soup, gaps))), soup)


@given(soup=triangle_soups().map(unshared), header=st.sampled_from([b"", b"solid ", b"solid a\nfacet normal", b"\0"]))
def test_every_face_in_binary_keeps_its_place(soup: Soup, header: bytes) -> None:
    file = binary([tuple(soup.vertices[corner] for corner in polygon) for polygon in soup.polygons], header)
    assert_is_soup(read(file), soup)
    assert slow_binary_stl(file) == (soup.vertices, soup.triangles)


@given(damaged([ASCII], b" \n\r\t0123456789.-+efacetnormalvrxdsoip\0\xff"))
def test_a_damaged_text_is_read_as_it_stands_or_refused(data: bytes) -> None:
    assert_agrees(data, "stl", slow_ascii_stl)


@given(damaged([BINARY, binary(TRIANGLES, b"solid")], b"\0\1\2\x7f\x80\xff\x3f"))
def test_a_damaged_binary_is_read_as_it_stands_or_refused(data: bytes) -> None:
    assert_agrees(data, "stl", slow_binary_stl)


@pytest.mark.parametrize("data", [ASCII, BINARY, binary(TRIANGLES, b"solid")], ids=["text", "binary", "solid binary"])
def test_a_cut_file_is_never_half_read(data: bytes) -> None:
    assert_never_half_read(data, SOUP, "stl")


@pytest.mark.parametrize("header", [b"", b"solid part", b"COLOR=\x01\x02\x03\x04"])
def test_bytes_after_the_faces_of_a_binary_are_passed_over(header: bytes) -> None:
    assert_is_soup(read(binary(TRIANGLES, header) + b"x" * 37), SOUP)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (ASCII.replace(b"vertex 1 0 0", b"vertex 1 x 0"), "Line 5: 'x' is not a number"),
        (ASCII.replace(b"vertex 1 0 0", b"vertex 1 vertex 0"), "Line 5: 'vertex' is not a number"),
        (ASCII.replace(b"vertex 0 1 .5\n", b"vertex 0 1 vertex "), "'vertex' in place of a number"),
        (ASCII.replace(b"vertex 0 1 .5\n", b"vertex 0 1 1vertex "), "'vertex' in place of a number"),
        (ASCII.replace(b"vertex 1 0 0", b"vertex 1 nan 0"), "Vertex 1"),
        (ASCII.replace(b"vertex 1 0 0\n", b""), "Line 2: this is not a whole STL face"),
        (ASCII.replace(b"0 1 .5\nendloop", b"0 1 .5"), "Line 9: this is not a whole STL face"),
        (ASCII.replace(b"endsolid a facet of it\n", b""), "endsolid"),
        (b"solid\nendsolid\n", "no faces"),
        (binary([]), "no faces"),
        (BINARY[:-1], "cut short"),
        (BINARY[:60], "header"),
        (binary([((0.0, float("nan"), 0.0), *TRIANGLES[0][1:])]), "Vertex 0"),
    ],
)
def test_a_wrong_file_is_refused_with_the_place(data: bytes, message: str) -> None:
    with pytest.raises(InvalidMesh, match=message):
        read(data, "stl")


@pytest.mark.parametrize("data", [ASCII, BINARY])
def test_counts_beyond_the_limits_are_refused_by_name(data: bytes) -> None:
    for limits, name in ((ReadLimits(max_faces=1), "max_faces = 1"), (ReadLimits(max_vertices=5), "max_vertices = 5")):
        with pytest.raises(LimitExceeded, match=name):
            read(data, limits=limits)


def test_several_solids_are_groups_and_one_solid_is_none() -> None:
    assert read(ASCII).structure is None
    assert read(BINARY).structure is None
    assert read(ASCII + b"\n" + ASCII).structure.group.tolist() == [0, 0, 1, 1]
