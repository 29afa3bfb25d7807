"""The Prefer header."""

import pytest

from service.submit.preference import Preference, read_preference


@pytest.mark.parametrize(
    ("prefer", "expected"),
    [
        (None, Preference(0.0, None)),
        ("respond-async", Preference(0.0, "respond-async")),
        ("wait=5", Preference(5.0, "wait=5")),
        ('respond-async, wait="5"', Preference(5.0, "wait=5")),
        ("wait=100000", Preference(60.0, "wait=60")),
        ("wait=0", Preference(0.0, "wait=0")),
        ("wait=-1, handling=lenient", Preference(0.0, None)),
        ("wait=five", Preference(0.0, None)),
    ],
)
def test_a_preference_is_parsed_from_the_header(prefer: str | None, expected: Preference) -> None:
    assert read_preference(prefer, 60.0) == expected
