"""The meshes and parameters of which digests are recorded."""

from pathlib import Path

import pytest

from bench.digests.selection import choices, choices_of, models_of
from bench.errors import BenchmarkError
from segcore.parameters import SegmentationParameters, parameters_schema


def test_models_of_both_data_sets_are_named_by_their_lists(strips: Path, assets: Path) -> None:
    keys = [subject.key for subject in models_of(strips, assets, 2)]
    assert keys == ["psb/1", "psb/3", "assets/props/crate", "assets/robots/bell"]


def test_choices_are_in_the_key_as_json(strips: Path, assets: Path) -> None:
    keys = [subject.key for subject in choices_of(strips, assets, [21])]
    assert len(keys) == 2 * len(choices()) == len(set(keys))
    assert 'psb/21 {"solver": "fiedler"}' in keys
    assert 'assets/props/crate {"affinity": "minima_rule", "graph": "vertices", "thinning": "walk"}' in keys
    with pytest.raises(BenchmarkError, match="no model 2 in"):
        choices_of(strips, assets, [2])


@pytest.mark.parametrize("name", ["preset", "graph", "affinity", "thinning", "solver", "order"])
def test_the_choices_cover_every_value(name: str) -> None:
    values = parameters_schema()["properties"][name]["enum"]
    defaults = set() if name == "preset" else {getattr(SegmentationParameters(), name)}
    assert defaults | {choice[name] for choice in choices() if name in choice} == set(values)


def test_every_choice_is_valid() -> None:
    for choice in choices():
        SegmentationParameters.from_mapping(choice)
