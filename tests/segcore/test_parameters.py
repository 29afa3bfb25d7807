from dataclasses import asdict, replace

import pytest

from segcore.errors import InvalidParameters
from segcore.parameters import SegmentationParameters, parameters_schema


@pytest.mark.parametrize(
    ("name", "value"),
    [("max_segments", 0), ("max_segments", 10_001), ("max_segments", 2.0), ("max_segments", True), ("seed", -1),
     ("seed", 2**32), ("starts", 0), ("iterations", 0), ("p", 1), ("p", 2.0), ("p", "1.5"), ("solver", "luck"),
     ("graph", "edges"), ("structure", "nodes"), ("affinity", ""), ("thinning", None), ("order", "ncc "),
     ("clusters", 99), ("clusters", "many")],
)  # fmt: skip
def test_a_value_outside_its_range_is_refused_with_name_and_value(name, value):
    with pytest.raises(InvalidParameters, match=f"{name} must be .*{value}"):
        SegmentationParameters(**{name: value})


def test_parameters_are_made_from_names_and_values():
    assert SegmentationParameters.from_mapping({"max_segments": 9}) == SegmentationParameters(max_segments=9)


def test_values_beside_a_preset_override_it():
    mapped = SegmentationParameters.from_mapping({"preset": "chahhou2014", "starts": 2})
    assert mapped == replace(SegmentationParameters.preset("chahhou2014"), starts=2)
    assert (mapped.graph, mapped.affinity, mapped.solver) == ("vertices", "minima_rule", "inverse_power")


def test_an_unknown_preset_is_refused_with_the_known_ones():
    with pytest.raises(InvalidParameters, match=r"one of chahhou2014, not 'nobody1999'"):
        SegmentationParameters.preset("nobody1999")


def test_an_unknown_name_is_refused_with_the_nearest_one_or_all():
    with pytest.raises(InvalidParameters, match=r"'segments'.*the nearest one is 'max_segments'"):
        SegmentationParameters.from_mapping({"segments": 9})
    with pytest.raises(InvalidParameters, match=r"'colour'.*affinity, .*max_segments, "):
        SegmentationParameters.from_mapping({"colour": 9})


def test_the_schema_has_a_description_and_the_default_of_every_parameter():
    properties = parameters_schema()["properties"]
    for name, value in asdict(SegmentationParameters()).items():
        assert properties[name]["default"] == value
        assert properties[name]["description"].endswith(".")
    assert set(properties) == {"preset", *asdict(SegmentationParameters())}


@pytest.mark.parametrize("name", ["starts", "iterations", "max_segments", "clusters", "seed"])
def test_exactly_the_values_of_the_schema_are_accepted(name):
    schema = parameters_schema()["properties"][name]
    limits = schema.get("anyOf", [schema])[0]
    for value in (limits["minimum"], limits["maximum"]):
        SegmentationParameters(**{name: value})
    for value in (limits["minimum"] - 1, limits["maximum"] + 1):
        with pytest.raises(InvalidParameters):
            SegmentationParameters(**{name: value})
