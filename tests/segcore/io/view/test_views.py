"""Views from any side: which parts are seen where, and their numbers in the picture."""

import numpy as np
import pytest

from segcore import Mesh
from segcore.errors import InvalidParameters
from segcore.io import view_of
from segcore.io.view.digits import number_stamp

# Four upright squares in the plane z = 0, the parts 0 to 3 from left to right, and a large part 4 behind them.
_SQUARES = [(x, 1.0, 0.0, 1.0) for x in (0.0, 1.0, 2.0, 3.0)] + [(0.0, 4.0, -1.0, 1.0)]
_VERTICES = [corner for x, w, z, h in _SQUARES for corner in ((x, 0.0, z), (x + w, 0.0, z), (x + w, h, z), (x, h, z))]
_FACES = [face for k in range(0, 20, 4) for face in ((k, k + 1, k + 2), (k, k + 2, k + 3))]
MESH = Mesh(np.array(_VERTICES), np.array(_FACES, dtype=np.int32))
LABELS = np.repeat(np.arange(5, dtype=np.int32), 2)
SIZE = 200


def test_parts_that_others_hide_are_not_seen() -> None:
    front = view_of(MESH, LABELS, SIZE, 0.0, 0.0).visible_parts()
    back = view_of(MESH, LABELS, SIZE, 180.0, 0.0).visible_parts()
    assert sorted(part.number for part in front) == [0, 1, 2, 3]
    assert [part.number for part in back] == [4]
    assert [part.number for part in sorted(front, key=lambda part: part.x)] == [0, 1, 2, 3]


@pytest.mark.parametrize(("azimuth", "elevation"), [(0.0, 0.0), (30.0, 20.0), (180.0, 0.0), (-40.0, -60.0)])
def test_the_place_of_a_number_shows_a_face_of_its_part(azimuth: float, elevation: float) -> None:
    view = view_of(MESH, LABELS, SIZE, azimuth, elevation)
    for part in view.visible_parts():
        face = view.face_at(part.x, part.y)
        assert face is not None
        assert LABELS[face] == part.number


def test_a_line_passes_the_faces_below_it_in_order() -> None:
    view = view_of(MESH, LABELS, SIZE, 0.0, 0.0)
    parts = LABELS[view.faces_between([(0, SIZE // 2 + 3), (SIZE - 1, SIZE // 2 + 3)])]
    assert parts[np.r_[True, np.diff(parts) != 0]].tolist() == [0, 1, 2, 3]
    assert view.face_at(0, 0) is None
    assert view.faces_between([(0, 0), (SIZE - 1, 0)]) == []


def test_a_pixel_outside_of_the_picture_is_refused() -> None:
    view = view_of(MESH, LABELS, SIZE, 0.0, 0.0)
    with pytest.raises(InvalidParameters, match=r"no pixel \(200, 0\): x and y are 0 to 199"):
        view.face_at(SIZE, 0)
    with pytest.raises(InvalidParameters, match=r"no pixel \(0, 200\)"):
        view.faces_between([(0, 0), (0, SIZE)])


def test_the_picture_has_the_numbers_of_the_parts_at_their_places() -> None:
    view = view_of(MESH, LABELS, SIZE, 0.0, 0.0)
    picture = view.numbered()
    assert (picture[..., 3] == 255).all()
    for part in view.visible_parts():
        stamp = number_stamp(part.number, 1)
        top, left = part.y - stamp.shape[0] // 2, part.x - stamp.shape[1] // 2
        assert (picture[top : top + stamp.shape[0], left : left + stamp.shape[1]] == stamp).all()


def test_numbers_do_not_cover_each_other() -> None:
    view = view_of(MESH, LABELS, 16, 0.0, 0.0)
    parts = view.visible_parts()
    assert {part.is_numbered for part in parts} == {True, False}
    assert view.numbered().shape == (16, 16, 4)


def test_every_digit_is_another_picture() -> None:
    stamps = {number_stamp(digit, 2).tobytes() for digit in range(10)}
    assert len(stamps) == 10
    assert number_stamp(10, 1).shape == (9, 13, 4)
