"""Operations on parts: what changes, what stays, and what is refused."""

import numpy as np
import pytest

from helpers.edits.guide import faces, tools
from segcore.edit.operations import (
    Assign,
    Border,
    Cut,
    Describe,
    FindPart,
    Merge,
    Operation,
    Restore,
    Smooth,
    apply_all,
    in_words,
)
from segcore.edit.tools import PartFinder, Tools
from segcore.errors import InvalidParameters, PartLocked
from segcore.io.palette import segment_color_names
from segcore.partition import Part, Partition

COLORS = segment_color_names(8)


def four_parts(**said: Part) -> Partition:
    """Two faces in each of the parts 0 to 3; ``said`` has what is said about them as p0 to p3."""
    return Partition(np.repeat(np.arange(4, dtype=np.int32), 2), tuple(said.get(f"p{k}", Part()) for k in range(4)))


def after(before: Partition, *operations: Operation) -> Partition:
    return apply_all(before, operations, tools(len(before.labels), before))


def test_any_parts_merge_and_the_others_keep_number_and_colour() -> None:
    merged = after(four_parts(p3=Part("ear")), Merge((2, 0)))
    assert merged.labels.tolist() == [2, 2, 1, 1, 2, 2, 0, 0] or merged.labels.tolist() == [0, 0, 1, 1, 0, 0, 2, 2]
    assert len(merged) == 3
    ear = next(label for label, part in enumerate(merged.parts) if part.name == "ear")
    assert merged.labels[6] == ear
    assert (merged.parts[ear].color or COLORS[ear]) == COLORS[3]


def test_the_part_with_the_highest_number_takes_the_place_of_one_that_vanishes() -> None:
    last = Part("tail", None, "limb", locked=True)
    moved = after(four_parts(p3=last), Assign(faces(2, 3), 0))
    assert moved.labels.tolist() == [0, 0, 0, 0, 2, 2, 1, 1]
    assert moved.parts == (Part(), Part("tail", COLORS[3], "limb", locked=True), Part())


def test_a_merged_part_has_the_first_name_and_class_of_its_parts() -> None:
    merged = after(four_parts(p1=Part("arm"), p3=Part("hand", "#102030", "limb")), Merge((0, 1, 3)))
    assert merged.parts[0] == Part("arm", None, "limb")


def test_a_new_part_has_a_colour_that_no_other_part_has() -> None:
    moved = after(four_parts(), Assign(faces(2, 3), 0))  # part 3 is part 1 now, with its old colour
    new = after(moved, Assign(faces(0), "new"))
    assert len({part.color or COLORS[label] for label, part in enumerate(new.parts)}) == 4
    assert new.labels.tolist() == [3, 0, 0, 0, 2, 2, 1, 1]


def test_marks_make_a_part_or_extend_one() -> None:
    assert after(four_parts(), FindPart(faces(0, 3), faces(), "new")).labels.tolist() == [4, 0, 1, 4, 2, 2, 3, 3]
    assert after(four_parts(), FindPart(faces(0, 3), faces(), 2)).labels.tolist() == [2, 0, 1, 2, 2, 2, 3, 3]


def test_a_stroke_cuts_a_part() -> None:
    assert after(four_parts(), Cut(1, faces(1, 3))).labels.tolist() == [0, 0, 1, 4, 2, 2, 3, 3]
    with pytest.raises(InvalidParameters, match="does not divide part 1"):
        after(four_parts(), Cut(1, faces(0)))
    with pytest.raises(InvalidParameters, match="does not divide part 1"):
        after(four_parts(), Cut(1, faces(2, 3)))


def test_a_border_changes_its_two_parts_only() -> None:
    assert after(four_parts(), Border(0, 1, faces(2, 4))).labels.tolist() == [0, 0, 0, 1, 2, 2, 3, 3]


def test_what_is_said_about_a_part_is_changed_and_removed() -> None:
    said = after(four_parts(), Describe(1, name="arm", color="#ff0000"), Describe(1, class_name="limb", locked=True))
    assert said.parts[1] == Part("arm", "#ff0000", "limb", locked=True)
    assert after(said, Describe(1, name="", color="", class_name="", locked=False)).parts[1] == Part()


def test_an_earlier_revision_is_restored_with_its_names_and_locks() -> None:
    before = four_parts(p2=Part("leg", locked=True))
    assert after(before, Describe(2, name="foot"), Merge((0, 1)), Restore(0)) is before


LOCKED = four_parts(p1=Part(locked=True))


@pytest.mark.parametrize(
    "operation",
    [
        Merge((0, 1)),
        Assign(faces(0), 1),
        Assign(faces(2, 3), 0),
        FindPart(faces(2), faces(), "new"),
        FindPart(faces(0), faces(), 1),
        Cut(1, faces(2)),
        Border(1, 0, faces(0)),
        Border(0, 1, faces(2)),
        Smooth((1,)),
    ],
)
def test_a_locked_part_is_refused_if_it_is_named(operation: Operation) -> None:
    with pytest.raises(PartLocked, match="unlock"):
        after(LOCKED, operation)


@pytest.mark.parametrize(
    "operation",
    [
        Assign(faces(0, 2, 4), "new"),
        Assign(faces(0, 2, 4), 3),
        FindPart(faces(1, 2, 6), faces(), "new"),
        Smooth(None),
        Merge((0, 2)),
        Describe(1, name="arm"),
    ],
)
def test_the_faces_of_a_locked_part_stay(operation: Operation) -> None:
    edited = after(LOCKED, operation)
    (locked,) = (label for label, part in enumerate(edited.parts) if part.locked)
    assert np.flatnonzero(edited.labels == locked).tolist() == [2, 3]


def test_smoothing_moves_no_face_into_a_locked_part() -> None:
    assert after(four_parts(p3=Part(locked=True)), Smooth(None)).labels.tolist() == [0, 0, 1, 1, 2, 2, 3, 3]
    assert after(four_parts(), Smooth(None)).labels.tolist() == [3, 0, 1, 1, 2, 2, 3, 3]


@pytest.mark.parametrize(
    ("operation", "sentence"),
    [
        (Merge((0, 4)), "The parts are 0 to 3: there is no part 4."),
        (Merge((2, 2)), "at least two"),
        (Assign(faces(8), 0), "The faces are 0 to 7: there is no face 8."),
        (Assign(faces(-1), 0), "there is no face -1"),
        (Assign(faces(), "new"), "at least one"),
        (FindPart(faces(), faces(1), "new"), "at least one face inside"),
        (FindPart(faces(1, 2), faces(2), "new"), "Face 2 is marked as inside and as outside"),
        (Cut(0, faces()), "give the faces below it"),
        (Border(2, 2, faces()), "two different ones"),
        (Describe(-1, name="arm"), "there is no part -1"),
    ],
)
def test_what_does_not_exist_is_refused(operation: Operation, sentence: str) -> None:
    with pytest.raises(InvalidParameters, match=sentence.replace("(", r"\(")):
        after(four_parts(), operation)


@pytest.mark.parametrize(
    ("operations", "words"),
    [
        ([Merge((1, 2))], "merge parts 1, 2"),
        ([Assign(faces(3, 4), "new"), Smooth(None)], "move 2 faces to a new part; smooth the borders"),
        ([Describe(1, name="arm")] * 2, "name part 1 'arm' (2 times)"),
        ([Describe(0, locked=True), Restore(3)], "lock part 0; restore revision 3"),
    ],
)
def test_operations_are_told_in_words(operations: list[Operation], words: str) -> None:
    assert in_words(operations) == words


def test_only_what_looks_at_the_surface_needs_a_guide() -> None:
    def no_guide() -> PartFinder:
        raise AssertionError("no Guide is needed")

    quick = (Merge((0, 1)), Assign(faces(0), 1), Describe(1, name="arm"), Restore(0))
    assert not any(operation.needs_guide for operation in quick)
    apply_all(four_parts(), quick, Tools(no_guide, lambda *_: four_parts()))
    assert all(kind.needs_guide for kind in (FindPart, Cut, Border, Smooth))
