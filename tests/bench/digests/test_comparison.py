"""Two files of digests."""

from pathlib import Path

import pytest

from bench.digests.comparison import compare, load_digests, render, save_digests
from bench.errors import BenchmarkError

A = {"psb/1": {"2": "aa", "glb": "bb", "segments": [3, 64]}, "psb/3": {"2": "cc"}, "psb/5": {"2": "dd"}}


def test_only_the_keys_in_both_files_are_compared() -> None:
    b = {"psb/1": {**A["psb/1"], "glb": "xx", "segments": [4, 64]}, "psb/3": A["psb/3"], "psb/7": {"2": "ee"}}
    comparison = compare(A, b)
    assert (comparison.equal, comparison.only_a, comparison.only_b) == (1, ["psb/5"], ["psb/7"])
    assert comparison.different == {"psb/1": ["glb", "segments"]}
    assert render(comparison).splitlines() == [
        "psb/1: glb, segments",
        "1 equal, 1 different, 1 only in A, 1 only in B.",
    ]


def test_a_missing_digest_is_a_difference() -> None:
    assert compare({"a": {"2": "x", "5": "y"}}, {"a": {"2": "x"}}).different == {"a": ["5"]}


def test_loaded_digests_are_the_saved_ones(tmp_path: Path) -> None:
    save_digests(tmp_path / "a.json", A)
    assert load_digests(tmp_path / "a.json") == A


def test_other_files_are_rejected(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    for content, message in (
        ("{", "is not JSON"),
        ("[]", "does not contain digests"),
        ('{"a": 1}', "does not contain"),
    ):
        path.write_text(content)
        with pytest.raises(BenchmarkError, match=message):
            load_digests(path)
    with pytest.raises(BenchmarkError, match="cannot be read"):
        load_digests(tmp_path / "none.json")
    with pytest.raises(BenchmarkError, match="cannot be written"):
        save_digests(tmp_path / "none" / "a.json", A)
