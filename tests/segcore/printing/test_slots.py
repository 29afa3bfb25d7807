"""Filament slots."""

import numpy as np
import pytest

from segcore.printing.slots import slots_of

COLORS = {0: "#ff0000", 1: "#00ff00", 2: "#fa0505", 3: "#ff0000", 4: "#0000ff"}


def test_parts_of_one_colour_share_a_slot() -> None:
    slots = slots_of(range(5), {}, 5, None, COLORS)
    assert [(slot.number, slot.color, slot.labels) for slot in slots] == [
        (1, "#ff0000", (0, 3)),
        (2, "#00ff00", (1,)),
        (3, "#fa0505", (2,)),
        (4, "#0000ff", (4,)),
    ]


def test_the_nearest_colours_are_joined_and_the_larger_one_remains() -> None:
    for volumes, kept in (({0: 1.0, 3: 1.0, 2: 5.0}, "#fa0505"), ({0: 4.0, 3: 4.0, 2: 5.0}, "#ff0000")):
        slots = slots_of(range(5), volumes, 5, 3, COLORS)
        assert [slot.labels for slot in slots] == [(0, 2, 3), (1,), (4,)]
        assert slots[0].color == kept


@pytest.mark.parametrize("most", [1, 2, 4, 7])
def test_every_part_has_one_slot_and_there_are_not_more_than_asked_for(most: int) -> None:
    slots = slots_of(range(30), {label: label + 1.0 for label in range(30)}, 30, most)
    assert len(slots) == most
    assert sorted(np.concatenate([slot.labels for slot in slots]).tolist()) == list(range(30))
