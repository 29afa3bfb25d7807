"""The PLY reader, for text and both byte orders: every face in its place, no file half read."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.appearances import read_look
from helpers.files.damage import assert_agrees, assert_never_half_read, damaged
from helpers.files.plain_readers import slow_ply
from helpers.files.ply import ENCODINGS, TYPES, Properties, Rows, ply
from helpers.files.polygon_soups import Soup, assert_is_soup, assert_same_mesh, read, soups
from helpers.files.samples import INDICES, XYZ
from helpers.files.samples import PLY as SQUARES
from helpers.files.samples import PLY_CORNERS as CORNERS
from helpers.files.samples import SQUARE as SOUP
from segcore.errors import InvalidMesh, LimitExceeded, UnsupportedFormat
from segcore.io import ReadLimits

MIXED_ELEMENTS: list[tuple[str, Properties, Rows]] = [
    ("camera", [("list", "uint16", "double", "matrix"), ("char", "on")], [[[1.5, 2.5], 1], [[], 0]]),
    (
        "vertex",
        [("uint8", "red"), *XYZ[::-1], ("list", "uint8", "short", "tags")],
        [[7, z, y, x, [1]] for x, y, z in SOUP.vertices],
    ),
    (
        "face",
        [("short", "flags"), ("list", "uint8", "uint32", "vertex_index"), ("list", "uint8", "float", "uv")],
        [[-1, [0, 1, 2], []], [2, [0, 1, 2, 3], [0.5, 0.5]], [3, [3, 2, 1], [0.25]]],
    ),
    ("edge", [("int", "vertex1"), ("int", "vertex2")], [[0, 1]]),
]
LONG_LINES = SQUARES["ascii"].replace(b"3 0 1 2\n", b"3 0 1 2 9 9\n").replace(b"3 0 2 3\n", b"3 0 2 3 9\n")
MIXED = [ply(name, MIXED_ELEMENTS) for name in ENCODINGS]


@st.composite
def ply_files(draw: st.DrawFn, soup: Soup) -> bytes:
    """The soup in any encoding, with other properties and elements around it."""
    count, index = (
        draw(st.sampled_from(["char", "uint8", "uint16", "int"])),
        draw(st.sampled_from(["uint8", "int", "float"])),
    )
    extra = draw(st.lists(st.sampled_from(list(TYPES)), max_size=2))
    at = draw(st.integers(0, len(extra)))
    vertex_properties = [(kind, f"extra{i}") for i, kind in enumerate(extra)]
    vertex_properties[at:at] = [(draw(st.sampled_from(["float", "double"])), axis) for axis in "xyz"]
    vertices = [[*([1] * at), *vertex, *([1] * (len(extra) - at))] for vertex in soup.vertices]
    face_properties: Properties = [("list", count, index, draw(st.sampled_from(["vertex_index", "vertex_indices"])))]
    faces: Rows = [[polygon] for polygon in soup.polygons]
    if draw(st.booleans()):
        face_properties.insert(draw(st.integers(0, 1)), ("list", "uint8", "float", "texcoord"))
        where = 0 if face_properties[0][3] == "texcoord" else 1
        for row in faces:
            row.insert(where, [0.5] * draw(st.integers(0, 2)))
    elements = [("vertex", vertex_properties, vertices), ("face", face_properties, faces)]
    for _ in range(draw(st.integers(0, 2))):
        name = draw(st.sampled_from(["edge", "range_grid", "m"]))
        if name not in [element[0] for element in elements]:
            rows = [[[1] * draw(st.integers(0, 2)), 2.5] for _ in range(draw(st.integers(0, 2)))]
            elements.insert(draw(st.integers(0, 2)), (name, [("list", "uint8", "int", "l"), ("float", "w")], rows))
    return ply(
        draw(st.sampled_from(list(ENCODINGS))), elements, draw(st.sampled_from(["\n", "\r\n", "\r", "\n\r"])), "a b"
    )


@given(data=st.data(), soup=soups())
def test_every_vertex_and_face_keeps_its_place_in_any_layout(data: st.DataObject, soup: Soup) -> None:
    file = data.draw(ply_files(soup))
    assert_is_soup(read(file), soup)
    assert slow_ply(file) == (soup.vertices, soup.triangles)


@given(damaged([SQUARES["ascii"], MIXED[0], LONG_LINES], b" \n\r\t0123456789.-+exyzlist\0\xff"))
def test_a_damaged_text_is_read_as_it_stands_or_refused(data: bytes) -> None:
    assert_agrees(data, "ply", slow_ply)


@given(damaged([SQUARES["binary_little_endian"], *MIXED[1:]], b" \n\r0123456789\0\1\2\3\x7f\x80\xff"))
def test_a_damaged_binary_is_read_as_it_stands_or_refused(data: bytes) -> None:
    assert_agrees(data, "ply", slow_ply)


@pytest.mark.parametrize("data", SQUARES.values(), ids=SQUARES)
def test_a_cut_file_is_never_half_read(data: bytes) -> None:
    assert_never_half_read(data, SOUP, "ply")


@pytest.mark.parametrize("data", MIXED, ids=ENCODINGS)
def test_polygons_of_all_sizes_and_other_elements_keep_the_order_of_the_file(data: bytes) -> None:
    mesh = read(data)
    assert_same_mesh(mesh, SOUP.vertices, [(0, 1, 2), (0, 1, 2), (0, 2, 3), (3, 2, 1)])
    assert mesh.source_polygon is not None
    assert mesh.source_polygon.tolist() == [0, 1, 1, 2]


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_strips_give_their_triangles_in_order_and_all_facing_the_same_way(encoding: str) -> None:
    strips: Rows = [[[0, 1, 2, 3, 3, -1, 2, 1, 0, -1, 0, -1]], [[3, 2, 1, 0]]]
    elements = [("vertex", XYZ, CORNERS), ("tristrips", [("list", "int", "int", "vertex_indices")], strips)]
    mesh = read(ply(encoding, elements))
    assert mesh.faces.tolist() == [[0, 1, 2], [1, 3, 2], [2, 3, 3], [2, 1, 0], [3, 2, 1], [2, 0, 1]]


def test_bytes_after_the_last_element_of_a_binary_are_passed_over() -> None:
    assert_is_soup(read(SQUARES["binary_big_endian"] + b"\n\n"), SOUP)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"3 0 2 3\n", b"3 0 2 4\n", "outside 0..3"),
        (b"3 0 2 3\n", b"3 0 2 -1\n", "outside 0..3"),
        (b"3 0 2 3\n", b"3 0 2 0.5\n", "not a whole number"),
        (b"3 0 2 3\n", b"3 0 2\n", "row 1 of the 2 rows of its element 'face'"),
        (b"3 0 2 3\n", b"-3 0 2 3\n", "row 1 of the 2 rows of its element 'face'"),
        (b"3 0 2 3\n", b"3 0 2 x\n", "Line 17: 'x' is not a number"),
        (b"3 0 2 3\n", b"3 0 2 3\n7", "Line 18: the PLY file goes on"),
        (b"0.5\n", b"nan\n", "Vertex 3"),
        (b"element face 2", b"element face 4000000000", "face"),
        (b"element face 2", b"element face -2", "Line 9"),
        (b"element face 2", b"element vertex 2", "Line 9"),
        (b"property float x", b"property float w", "no property 'x'"),
        (b"property float x", b"property quad x", "Line 6"),
        (b"vertex_indices", b"corners", "no list 'vertex_indices'"),
        (b"list uint8", b"list float", "Line 10: the length"),
        (b"format ascii 1.0\n", b"", "no 'format' line"),
        (b"end_header", b"end_heade", "end_header"),
    ],
)
def test_a_wrong_file_is_refused_with_the_place(old: bytes, new: bytes, message: str) -> None:
    with pytest.raises((InvalidMesh, LimitExceeded), match=message):
        read(SQUARES["ascii"].replace(old, new))


def test_whole_numbers_that_no_integer_holds_are_still_coordinates() -> None:
    mesh = read(SQUARES["ascii"].replace(b"0.0 1.0 0.5", b"0 100000000000000000000 -9223372036854775808"))
    assert mesh.vertices[3].tolist() == [0.0, 1e20, -(2.0**63)]


def test_points_alone_are_refused() -> None:
    for encoding in ENCODINGS:
        with pytest.raises(InvalidMesh, match="no faces"):
            read(ply(encoding, [("vertex", XYZ, CORNERS)]))


def test_an_unknown_encoding_is_refused_by_name() -> None:
    with pytest.raises(UnsupportedFormat, match="binary_middle_endian"):
        read(SQUARES["ascii"].replace(b"ascii", b"binary_middle_endian"))


@pytest.mark.parametrize("data", SQUARES.values(), ids=SQUARES)
def test_counts_beyond_the_limits_are_refused_by_name(data: bytes) -> None:
    for limits, name in ((ReadLimits(max_faces=1), "max_faces = 1"), (ReadLimits(max_vertices=3), "max_vertices = 3")):
        with pytest.raises(LimitExceeded, match=name):
            read(data, limits=limits)


@pytest.mark.parametrize(("kind", "value", "expected"), [("uint8", 51, 51), ("uint16", 13107, 51), ("float", 0.2, 51)])
def test_ply_colours_of_any_type(kind: str, value: float, expected: int) -> None:
    columns = [*XYZ, (kind, "red"), (kind, "green"), (kind, "blue")]
    top = {"uint8": 255, "uint16": 65535, "float": 1.0}[kind]
    rows = [[*vertex, value, 0, top] for vertex in SOUP.vertices]
    data = ply("binary_big_endian", [("vertex", columns, rows), ("face", INDICES, [[[0, 1, 2]]])])
    assert read_look(data).colors.tolist() == [[expected, 0, 255, 255]] * 4


@pytest.mark.parametrize("line_end", ["\n", "\r", "\r\n", "\n\r", "\r\r\n"])
@pytest.mark.parametrize("x", [0x0A0A0A0A, 0x0D0D0D0D, 0x0A0D0A0D, 0x0D0A0D0A])
def test_the_first_bytes_of_binary_data_may_look_like_line_ends(line_end: str, x: int) -> None:
    columns: Properties = [("uint32", "x"), ("uint32", "y"), ("uint32", "z")]
    corners: Rows = [[x, 0, 0], [0, 1, 0], [0, 0, 1]]
    data = ply("binary_big_endian", [("vertex", columns, corners), ("face", INDICES, [[[0, 1, 2]]])])
    begin = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:begin].replace(b"\n", line_end.encode())
    assert_same_mesh(read(header + data[begin:]), [tuple(corner) for corner in corners], [(0, 1, 2)])


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_header_may_have_line_ends_of_two_kinds(encoding: str) -> None:
    data = SQUARES[encoding]
    begin = data.index(b"element")
    end = data.index(b"end_header\n") + len(b"end_header\n")
    assert_is_soup(read(data[:begin] + data[begin:end].replace(b"\n", b"\r\n") + data[end:]), SOUP)
    assert_is_soup(read(data[:begin].replace(b"\n", b"\r\n") + data[begin:]), SOUP)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_the_first_word_may_be_in_upper_case(encoding: str) -> None:
    assert_is_soup(read(SQUARES[encoding].replace(b"ply", b"PLY", 1)), SOUP)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_comment_may_go_on_in_another_line_before_the_first_element(encoding: str) -> None:
    broken = b"Created by a program, source file:\n"
    for after in (b"ply\n", SQUARES[encoding][: SQUARES[encoding].index(b"element")]):
        assert_is_soup(read(SQUARES[encoding].replace(after, after + broken, 1)), SOUP)
    with pytest.raises(InvalidMesh, match="Line 6: 'Created by"):
        read(SQUARES[encoding].replace(b"property", broken + b"property", 1))


def test_what_a_line_has_too_much_is_ignored_with_a_note() -> None:
    mesh = read(LONG_LINES)
    assert_is_soup(mesh, SOUP)
    assert mesh.notes == (
        "2 of the 2 lines of the element 'face' have more values than the header declares, first line 16: "
        "the rest of each line was ignored.",
    )
    assert read(SQUARES["ascii"]).notes == ()


@pytest.mark.parametrize("more", ["255 255 255", "0", "3 0 1 2", "white", "nan"])
def test_every_line_may_have_more_values_than_declared(more: str) -> None:
    head, body = SQUARES["ascii"].decode().split("end_header\n")
    lines = "".join(f"{line} {more}\n" for line in body.splitlines())
    mesh = read(f"{head}end_header\n{lines}".encode())
    assert_is_soup(mesh, SOUP)
    assert len(mesh.notes) == 2


def test_what_a_line_has_too_little_is_not_taken_from_another_line() -> None:
    head, body = SQUARES["ascii"].split(b"end_header\n")
    first, second, *others = body.splitlines(keepends=True)
    moved = [first.replace(b"\n", b" 7\n"), second.rpartition(b" ")[0] + b"\n", *others]
    with pytest.raises(InvalidMesh, match=r"Line \d+ of the PLY file: it has fewer values"):
        read(head + b"end_header\n" + b"".join(moved))


def test_lists_of_other_values_than_declared_do_not_move_the_next_line() -> None:
    head = SQUARES["ascii"].decode().split("element face")[0]
    head += "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
    head += "".join(f"property uchar {name}\n" for name in ("red", "green", "blue", "alpha")) + "end_header\n"
    points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
    faces = f"3 0 1 2 6 {'0.5 ' * 6}9 {'1 ' * 9}\n4 0 1 2 3 8 {'0.5 ' * 8}12 {'1 ' * 12}\n"
    mesh = read((head + points + faces).encode())
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 1, 2], [0, 2, 3]]
    assert mesh.source_polygon is not None
    assert mesh.source_polygon.tolist() == [0, 1, 1]


def test_colours_are_the_same_if_lines_are_too_long() -> None:
    columns = [*XYZ, ("uint8", "red"), ("uint8", "green"), ("uint8", "blue")]
    rows = [[*vertex, 51, 0, 255] for vertex in SOUP.vertices]
    data = ply("ascii", [("vertex", columns, rows), ("face", INDICES, [[[0, 1, 2]]])])
    longer = data.replace(b"3 0 1 2\n", b"3 0 1 2 7\n")
    assert read_look(longer).colors.tolist() == read_look(data).colors.tolist()
    head, body = data.split(b"end_header\n")
    every = head + b"end_header\n" + body.replace(b"\n", b" 7\n")
    assert read_look(every).colors.tolist() == read_look(data).colors.tolist()


@pytest.mark.parametrize(("kind", "full"), [("uint8", 1), ("uint16", 0), ("float", 255)])
@pytest.mark.parametrize("more", ["", " 7"])
@pytest.mark.parametrize("x", ["1", "1.5"])
def test_the_declared_type_of_colours_counts_and_not_how_they_are_written(
    kind: str, full: int, more: str, x: str
) -> None:
    columns = [*XYZ, *((kind, name) for name in ("red", "green", "blue"))]
    rows = [[*vertex, 1, 0, 1] for vertex in [(0, 0, 0), (2, 0, 0), (0, 3, 0)]]
    head, body = ply("ascii", [("vertex", columns, rows), ("face", INDICES, [[[0, 1, 2]]])]).split(b"end_header\n")
    lines = body.replace(b".0", b"").replace(b"2 0 0", f"{x} 0 0".encode()).replace(b"\n", f"{more}\n".encode())
    assert read_look(head + b"end_header\n" + lines).colors.tolist() == [[full, 0, full, 255]] * 3


def test_a_face_whose_number_of_corners_is_too_small_for_its_line_is_damage() -> None:
    data = ply("ascii", [("vertex", XYZ, [list(vertex) for vertex in SOUP.vertices]), ("face", INDICES, [[[0, 1, 2]]])])
    for row in (b"2 0 1 2\n", b"1 0 1 2\n", b"0 0 1 2\n"):
        with pytest.raises(InvalidMesh):
            read(data.replace(b"3 0 1 2\n", row))
