"""The words for parameters match the parameters."""

from segcore.parameter_words import ABOUT, CHOICES, TITLES
from segcore.parameters import parameters_schema


def test_every_parameter_and_every_choice_has_a_title() -> None:
    schema = parameters_schema()["properties"]
    assert list(TITLES) == list(schema)
    for name, choices in CHOICES.items():
        assert list(choices) == schema[name].get("enum", [])
        assert schema[name]["x-advanced"] is False
    assert set(ABOUT) == set(CHOICES)
    assert len(set(TITLES.values())) == len(TITLES)
