import pytest

from segcore.errors import InvalidParameters
from segcore.parameters import SegmentationParameters


@pytest.mark.parametrize(
    ("name", "value"),
    [("max_segments", 0), ("max_segments", 10_001), ("max_segments", 2.0), ("max_segments", True), ("seed", -1),
     ("seed", 2**32), ("clusters", 99), ("clusters", "many")],
)  # fmt: skip
def test_a_value_outside_its_range_is_refused_with_name_and_value(name, value):
    with pytest.raises(InvalidParameters, match=f"{name} must be .*{value}"):
        SegmentationParameters(**{name: value})


def test_parameters_come_from_names_and_values():
    assert SegmentationParameters.from_mapping({"max_segments": 9}) == SegmentationParameters(max_segments=9)


def test_an_unknown_name_is_refused_with_the_known_ones():
    with pytest.raises(InvalidParameters, match=r"'segments'.*affinity, .*max_segments, "):
        SegmentationParameters.from_mapping({"segments": 9})
