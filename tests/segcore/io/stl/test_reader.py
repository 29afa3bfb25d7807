"""The STL reader, for text and binary: every face in its place, no file half read."""

import numpy as np
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
from segcore.mesh import face_normals_and_areas

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


END = b"endsolid a facet of it\n"


@pytest.mark.parametrize(
    "end",
    [
        b"end solid a\n",
        b"endsolid",
        b"ENDSOLID A\n",
        b"End Solid\r\n",
        b"  end\tsolid a\n",
        b"end_solid\n",
        b"endsolida\n",
        b"endsolid a\n# exported by Foo 1.0\n",
        b"endsolid a\n\n// a comment about a facet and its vertex\nunits mm\n",
    ],
)
def test_the_end_of_a_solid_is_read_as_programs_write_it(end: bytes) -> None:
    assert_is_soup(read(ASCII.replace(END, end), "stl"), SOUP)
    two = read(ASCII.replace(END, end) + b"\n" + ASCII.replace(END, end), "stl")
    assert two.structure is not None
    assert two.structure.group.tolist() == [0, 0, 1, 1]


@pytest.mark.parametrize(
    "line", [b"color 0.5 0.5 0.5", b"  attribute 7", b"# facet 2", b"; vertex 1 2 3", b"\xff", b"usemtl facet"]
)
@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
def test_lines_between_faces_are_skipped_with_a_note(line: bytes, end: bytes) -> None:
    for before in (b"facet normal", b"endsolid"):
        data = ASCII.replace(before, line + b"\n" + before).replace(b"\n", end)
        mesh = read(data, "stl", appearance=True)
        assert_is_soup(mesh, SOUP)
        (note,) = mesh.notes
        assert "no part of a face were skipped" in note
        assert_is_soup(read(data.replace(b"0" + end, b"0 "), "stl"), SOUP)
    assert mesh.appearance is not None
    assert mesh.appearance.group_names == ("a facet of it",)
    assert_never_half_read(ASCII.replace(b"facet normal", line + b"\nfacet normal"), SOUP, "stl")


def test_a_colour_before_the_first_face_does_not_hide_the_format() -> None:
    assert_is_soup(read(ASCII.replace(b"of it\nfacet", b"of it\ncolor 1 1 1\nfacet", 1)), SOUP)
    assert_is_soup(read(b"# a comment\n" + ASCII), SOUP)


@pytest.mark.parametrize(
    "damage",
    [
        (b"facet normal 0 0 1\nouter", b"fcet normal 0 0 1\nouter"),
        (b"outer loop\n", b"color 1 1 1\nouter loop\n"),
        (b"endfacet\n", b"\n"),
        (END, b""),
        (END, END + b"facet normal 0 0 1\nouter loop\n"),
        (END, END + b"solid b\n"),
        (ASCII[20:110].replace(b"\n", b" "), b"fcet" + ASCII[25:110].replace(b"\n", b" ")),
    ],
)
def test_damage_to_a_face_is_not_taken_for_a_line_between_faces(damage: tuple[bytes, bytes]) -> None:
    data = ASCII if damage[0] in ASCII else ASCII[:20] + ASCII[20:110].replace(b"\n", b" ") + ASCII[110:]
    assert damage[0] in data
    with pytest.raises(InvalidMesh):
        read(data.replace(*damage), "stl")


def counted(count: int, header: bytes = b"") -> bytes:
    data = binary(TRIANGLES, header)
    return data[:80] + count.to_bytes(4, "little") + data[84:]


@pytest.mark.parametrize("header", [b"", b"solid part", b"\0"])
@pytest.mark.parametrize("count", [0, 1, 2**32 - 1])
def test_the_size_of_a_binary_decides_if_its_number_of_faces_is_none_or_too_small(count: int, header: bytes) -> None:
    mesh = read(counted(count, header), "stl")
    assert_is_soup(mesh, SOUP)
    (note,) = mesh.notes
    assert f"says {count}; there are 2" in note


def test_a_binary_without_the_field_for_its_number_of_faces_is_read_if_the_normals_agree() -> None:
    data = BINARY[:80] + BINARY[84:]
    with pytest.raises(InvalidMesh, match="announces"):
        read(data, "stl")
    corners = np.array(TRIANGLES)
    normals = face_normals_and_areas(corners)[0].astype("<f4")
    for i in range(2):
        data = data[: 80 + 50 * i] + normals[i].tobytes() + data[92 + 50 * i :]
    if data[80:84] == bytes(4):
        normals[0, 0] = 1e-3
        data = data[:80] + normals[0].tobytes() + data[92:]
    mesh = read(data, "stl")
    assert_is_soup(mesh, SOUP)
    assert "is missing" in mesh.notes[0]


@pytest.mark.parametrize(("count", "size"), [(0, 37), (2**32 - 1, 37), (3, 0), (1_000, 37), (0, -1)])
def test_a_number_of_faces_that_does_not_fit_is_refused_with_the_number_and_the_size(count: int, size: int) -> None:
    data = (counted(count) + bytes(max(size, 0)))[: len(BINARY) + size]
    with pytest.raises(InvalidMesh, match=f"announces {count} faces.*{len(data)}"):
        read(data, "stl")


@pytest.mark.parametrize("sizes", [(2, 2), (0, 5), (7, 0), (300, 1)])
def test_bytes_that_an_attribute_announces_are_skipped(sizes: tuple[int, int]) -> None:
    data = BINARY[:84]
    for i, size in enumerate(sizes):
        data += BINARY[84 + 50 * i : 132 + 50 * i] + size.to_bytes(2, "little") + b"A" * size
    mesh = read(data, "stl")
    assert_is_soup(mesh, SOUP)
    assert len(mesh.notes) == 1


def test_bytes_between_faces_that_nothing_announces_are_refused() -> None:
    ball = [tuple((x + i, y, z) for x, y, z in TRIANGLES[0]) for i in range(40)]
    data = binary(ball)
    faces = b"".join(data[84 + 50 * i : 134 + 50 * i] + b"AB" for i in range(40))
    with pytest.raises(InvalidMesh, match="not coordinates"):
        read(data[:84] + faces + b"AB", "stl")


def test_colours_in_attributes_announce_no_bytes() -> None:
    assert read(BINARY).notes == ()


def test_zeros_after_the_faces_are_no_faces() -> None:
    assert_is_soup(read(BINARY + bytes(100)), SOUP)
