"""Processes of the benchmarks, and their number of threads."""

import os

import pytest

from bench.errors import BenchmarkError
from bench.pool import THREAD_SETTINGS, map_in_processes, one_thread, one_thread_by_default


def test_processes_have_one_thread_and_the_environment_is_restored(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(THREAD_SETTINGS[0], "7")
    monkeypatch.delenv(THREAD_SETTINGS[1], raising=False)
    with one_thread():
        assert [os.environ[name] for name in THREAD_SETTINGS] == ["1"] * len(THREAD_SETTINGS)
    assert os.environ[THREAD_SETTINGS[0]] == "7"
    assert THREAD_SETTINGS[1] not in os.environ


def test_the_environment_may_set_another_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(THREAD_SETTINGS[0], "7")
    monkeypatch.delenv(THREAD_SETTINGS[1], raising=False)
    with one_thread_by_default():
        assert os.environ[THREAD_SETTINGS[0]] == "7"
        assert os.environ[THREAD_SETTINGS[1]] == "1"
    assert THREAD_SETTINGS[1] not in os.environ


def test_results_come_from_other_processes_in_the_order_of_the_items() -> None:
    assert map_in_processes(len, ["a", "", "bbb"], 2, os.getpid) == [1, 0, 3]
    assert map_in_processes(os.getpgid, [0], 1, os.setpgrp) != [os.getpgid(0)]  # the warm-up ran there


def test_a_process_that_ends_early_is_an_error() -> None:
    with pytest.raises(BenchmarkError, match="ended early"):
        map_in_processes(os._exit, [3], 1, os.getpid)
