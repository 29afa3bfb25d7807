"""Damaged files: cut short, with bytes changed, lost or repeated."""

from collections.abc import Callable

from hypothesis import strategies as st

from helpers.files.polygon_soups import Soup, read_or_none, source_polygons


@st.composite
def damaged(draw: st.DrawFn, files: list[bytes], alphabet: bytes) -> bytes:
    """One of the files after one to three damages; new bytes are from ``alphabet``."""
    data = draw(st.sampled_from(files))
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, len(data)))
        length = draw(st.integers(0, 6))
        kind = draw(st.sampled_from(("change", "lose", "repeat", "insert")))
        new = bytes(draw(st.lists(st.sampled_from(alphabet), max_size=3)))
        middle = {
            "change": new,
            "lose": b"",
            "repeat": 2 * data[at : at + length],
            "insert": new + data[at : at + length],
        }
        data = data[:at] + middle[kind] + data[at + length :]
    return data


def assert_never_half_read(data: bytes, whole: Soup, format: str) -> None:  # noqa: A002
    """Cut after any byte, a file is refused, or read completely if only white space at its end is lost."""
    for length in range(len(data)):
        mesh = read_or_none(data[:length], format)
        if mesh is not None:
            assert mesh.vertices.tolist() == [list(vertex) for vertex in whole.vertices], length
            assert mesh.faces.tolist() == [list(triangle) for triangle in whole.triangles], length
            assert source_polygons(mesh) == whole.source_polygons


def assert_agrees(data: bytes, format: str, slow_reader: Callable[[bytes], tuple[list, list]]) -> None:  # noqa: A002
    """A file is read as the slow reader reads it; a file that the slow reader refuses is refused."""
    mesh = read_or_none(data, format)
    if mesh is not None:
        vertices, faces = slow_reader(data)
        assert mesh.vertices.tolist() == [list(vertex) for vertex in vertices]
        assert mesh.faces.tolist() == [list(face) for face in faces]
