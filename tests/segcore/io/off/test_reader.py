"""The OFF reader: every face in its place in any layout of the file, no file half read."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.appearances import read_look
from helpers.files.damage import assert_agrees, assert_never_half_read, damaged
from helpers.files.plain_readers import slow_off
from helpers.files.polygon_soups import Soup, assert_is_soup, read, soups
from helpers.files.samples import OFF as SQUARE
from helpers.files.samples import SQUARE as SOUP
from segcore.errors import InvalidMesh, LimitExceeded, UnsupportedFormat
from segcore.io import ReadLimits

MIXED = (
    b"COFF # made by hand\n5 3 9\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n1 1 0 1 0 0 1\n0 1 0 1 0 0 1\n.5 .5 1 0 1 0 1\n"
    b"4 0 1 2 3 255 0 0\n3 0 1 4 0.5 0.5 0.5 1\n5 0 1 2 3 4\n"
)
TWO_COUNTS = SQUARE.replace(b"4 2 0", b"4 2")
line_ends = st.sampled_from(["\n", "\r\n", "\n\n", " \t\n", "\n# a comment 1 2 3\n", " # 7\n"])
gaps = st.sampled_from([" ", "  ", "\t", " \t "])
colors = st.sampled_from(["", " 7", " 255 0 0", " 0.5 0.25 1", " 1 0 0 0.5"])


@st.composite
def off_files(draw: st.DrawFn, soup: Soup) -> bytes:
    """The soup with any prefix, gaps, line ends, comments and face colours."""
    texture, color, normal = (draw(st.sampled_from(["", prefix])) for prefix in ("ST", "C", "N"))
    prefixes = "".join(draw(st.permutations([texture, color, normal])))
    extra = (3 if normal else 0) + (4 if color else 0) + (2 if texture else 0)
    edges = draw(st.sampled_from([" 0", ""])) if len(soup.vertices) else " 0"
    counts = f"{len(soup.vertices)} {len(soup.polygons)}{edges}"
    lines = [f"{prefixes}OFF{draw(st.sampled_from([' ', chr(10)]))}{counts}"]
    lines += [" ".join(map(repr, vertex)) + " 0.5" * extra for vertex in soup.vertices]
    lines += [draw(gaps).join(map(str, [len(p), *p])) + draw(colors) for p in soup.polygons]
    return "".join(line + draw(line_ends) for line in lines).encode()


@st.composite
def streams(draw: st.DrawFn, soup: Soup) -> bytes:
    """The soup without colours, with line breaks anywhere within its records."""
    words = ["OFF\n", f"{len(soup.vertices)} {len(soup.polygons)} 0\n"]
    for vertex in soup.vertices:
        words += [repr(value) + draw(st.sampled_from([" ", "\n"])) for value in vertex]
    words[-1] = words[-1].strip() + "\n"
    for polygon in soup.polygons:
        words += [f"{word}{draw(st.sampled_from([' ', chr(10)]))}" for word in [len(polygon), *polygon]]
        words[-1] = words[-1].strip() + "\n"
    return "".join(words).encode()


@given(data=st.data(), soup=soups())
def test_every_vertex_and_face_keeps_its_place_in_any_layout(data: st.DataObject, soup: Soup) -> None:
    file = data.draw(off_files(soup))
    assert_is_soup(read(file), soup)
    assert slow_off(file) == (soup.vertices, soup.triangles)


@given(data=st.data(), soup=soups())
def test_records_may_be_broken_over_lines(data: st.DataObject, soup: Soup) -> None:
    file = data.draw(streams(soup))
    assert_is_soup(read(file), soup)
    assert slow_off(file) == (soup.vertices, soup.triangles)


@given(damaged([SQUARE, MIXED, TWO_COUNTS, SQUARE.replace(b"\n", b"\r\n")], b" \n\r\t#0123456789.-+eEOFCNST\0\xff"))
def test_a_damaged_file_is_read_as_it_stands_or_refused(data: bytes) -> None:
    assert_agrees(data, "off", slow_off)


@pytest.mark.parametrize("data", [SQUARE, TWO_COUNTS], ids=["three counts", "two counts"])
def test_a_cut_file_is_never_half_read(data: bytes) -> None:
    assert_never_half_read(data, SOUP, "off")


@pytest.mark.parametrize(
    "data",
    [
        SQUARE.removesuffix(b"\n"),
        SQUARE.replace(b"OFF\n", b"OFF "),
        SQUARE.replace(b"OFF\n", b"OFF"),
        SQUARE.replace(b"\n", b"\r"),
        b"\xef\xbb\xbf" + SQUARE,
        SQUARE + b"\0" * 500,
        SQUARE + b"\x1a",
        b"# a comment before the keyword\n\n" + SQUARE,
        b"COFF\n4 2 0\n0 0 0 9 9 9\n1 0 0 9 9 9\n1 1 0 9 9 9\n0 1 .5 9 9 9\n3 0 1 2\n3 0 2 3\n",
        SQUARE.replace(b"1 0 0", b"1 0 0 0.5 0.5 0.5"),
        TWO_COUNTS,
        TWO_COUNTS.replace(b"OFF\n", b"OFF "),
        TWO_COUNTS.replace(b"4 2\n", b"4 2  # vertices and faces\n\n# no edges\n"),
        SQUARE.replace(b"4 2 0", b"4\n2\n0"),
        SQUARE.replace(b"4 2 0", b"4 2\n0"),
        SQUARE.replace(b"4 2 0", b"4\n2 0"),
        SQUARE.replace(b"4 2 0", b"4\n2"),
    ],
    ids=[
        "no end of line",
        "counts on the first line",
        "counts glued on",
        "CR",
        "BOM",
        "NUL",
        "DOS",
        "comment",
        "RGB",
        "undeclared",
        "no edges",
        "no edges, on the first line",
        "no edges, comments",
        "a count a line",
        "edges on a line of their own",
        "vertices on a line of their own",
        "no edges, a count a line",
    ],
)
def test_usual_variants_are_read(data: bytes) -> None:
    assert_is_soup(read(data), SOUP)


@pytest.mark.parametrize("data", [SQUARE[4:], b"# made by hand\n\n" + SQUARE[4:], SQUARE[4:].replace(b"4 2 0", b"4 2")])
def test_the_word_off_may_be_missing_if_the_format_is_declared(data: bytes) -> None:
    assert read(data, "off").faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    with pytest.raises(UnsupportedFormat):
        read(data)


def test_polygons_of_all_sizes_keep_the_order_of_the_file() -> None:
    mesh = read(MIXED)
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4], [0, 1, 2], [0, 2, 3], [0, 3, 4]]
    assert mesh.source_polygon is not None
    assert mesh.source_polygon.tolist() == [0, 0, 1, 2, 2, 2]


def test_a_polygon_without_area_has_no_faces_but_keeps_its_number() -> None:
    mesh = read(SQUARE.replace(b"4 2 0", b"4 3 0").replace(b"3 0 1 2", b"2 0 1\n3 0 1 2"))
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert mesh.source_polygon is not None
    assert mesh.source_polygon.tolist() == [1, 2]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"1 1 0", b"1 x 0", "Line 5: 'x' is not a number"),
        (b"1 1 0", b"1 1\x000", "Byte 25: .* control character"),
        (b"1 1 0", b"1 nan 0", "not finite"),
        (b"1 1 0", b"1 1e999 0", "not finite"),
        (b"3 0 2 3", b"3 0 2 4", "outside 0..3"),
        (b"3 0 2 3", b"3 0 2 -1", "outside 0..3"),
        (b"3 0 2 3", b"3 0 2 1.5", "not whole"),
        (b"3 0 2 3", b"3 0 2", "cut short"),
        (b"3 0 2 3", b"-3 0 2 3", "Line 8"),
        (b"3 0 2 3", b"nan 0 2 3", "Line 8"),
        (b"3 0 2 3\n", b"", "cut short"),
        (b"3 0 2 3\n", b"3 0 2 3\n3 0 1 3\n", "Line 9.*goes on"),
        (b"4 2 0", b"4 -2 0", "must be whole"),
        (b"4 2 0", b"4 0 0", "goes on"),
        (b"4 2 0", b"4 4000 0", "cut short"),
    ],
)
def test_a_wrong_file_is_refused_with_the_place(old: bytes, new: bytes, message: str) -> None:
    with pytest.raises(InvalidMesh, match=message):
        read(SQUARE.replace(old, new))


def test_counts_beyond_the_limits_are_refused_by_name() -> None:
    for limits, name in ((ReadLimits(max_faces=1), "max_faces = 1"), (ReadLimits(max_vertices=3), "max_vertices = 3")):
        with pytest.raises(LimitExceeded, match=name):
            read(SQUARE, limits=limits)


@pytest.mark.parametrize("keyword", [b"4OFF", b"nOFF", b"OFF BINARY", b"N4OFF", b"CnSTOFF"])
def test_other_kinds_of_off_are_refused_as_such(keyword: bytes) -> None:
    with pytest.raises(UnsupportedFormat, match="plain OFF"):
        read(SQUARE.replace(b"OFF", keyword))


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


@pytest.mark.parametrize("keyword", ["NCOFF", "CNOFF"])
@pytest.mark.parametrize("row", ["{normal} {color}", "{color} {normal}"])
@pytest.mark.parametrize(
    ("color", "expected"),
    [
        ("255 0 0 128", [255, 0, 0, 128]),
        ("0.2 1 0 1", [51, 255, 0, 255]),
        ("1 0 0 1", [255, 0, 0, 255]),
        ("10 20 30", [10, 20, 30, 255]),
    ],
)
def test_normals_and_colours_in_any_order(keyword: str, row: str, color: str, expected: list[int]) -> None:
    normals = ["0 0 1", "0 0.6 0.8", "-0.57735 0.57735 0.57735"]
    places = ["0 0 0", "1 0 0", "0 1 0"]
    rows = [f"{place} {row.format(normal=normal, color=color)}" for place, normal in zip(places, normals, strict=True)]
    data = "\n".join([keyword, "3 1 0", *rows, "3 0 1 2\n"]).encode()
    look = read_look(data)
    assert look.colors.tolist() == [expected] * 3
    assert look.normals[1].tolist() == pytest.approx([0, 0.6, 0.8])
    assert read(data).vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize("keyword", ["NCSTOFF", "CSTNOFF", "NSTCOFF", "STNCOFF"])
def test_texture_coordinates_are_last_with_any_order_of_the_prefixes(keyword: str) -> None:
    rows = ["0 0 0  0 0 1  255 0 0 128  0 1", "1 0 0  0 1 0  0 255 0 255  .5 .25", "0 1 0  1 0 0  1 2 3 4  1 1"]
    look = read_look((f"{keyword}\n3 1\n" + "\n".join(rows) + "\n3 0 1 2\n").encode())
    assert look.normals.tolist() == [[0, 0, 1], [0, 1, 0], [1, 0, 0]]
    assert look.colors.tolist() == [[255, 0, 0, 128], [0, 255, 0, 255], [1, 2, 3, 4]]
    assert look.uvs.tolist() == [[0, 1], [0.5, 0.25], [1, 1]]
