"""Work ends with its results or with a sentence; results are kept within a limit."""

from typing import Any

import pytest

from integrations.blender.cache import Cache
from integrations.blender.errors import CanceledError, CleaveError
from integrations.blender.work import Watch, Work


def test_tasks_are_carried_out_in_their_order() -> None:
    order: list[str] = []
    work = Work({name: lambda _, name=name: order.append(name) or name.upper() for name in "ab"}, limit_s=60)
    work.start()
    work.join()
    assert (order, work.results, work.error) == (["a", "b"], {"a": "A", "b": "B"}, None)


def test_the_results_before_an_error_are_kept() -> None:
    def fail(_: Watch) -> Any:
        raise ZeroDivisionError("by zero")

    work = Work({"a": lambda _: 1, "b": fail, "c": lambda _: 3}, limit_s=60)
    work.run()
    assert work.results == {"a": 1}
    assert str(work.error) == "Unexpected error in the extension: ZeroDivisionError: by zero"


def test_stopped_work_ends_at_its_next_pause() -> None:
    work = Work({"a": lambda watch: watch.pause(60.0)}, limit_s=60)
    work.start()
    work.watch.stop()
    work.join()
    assert isinstance(work.error, CanceledError)


def test_work_ends_with_its_time() -> None:
    work = Work({"a": lambda watch: watch.pause(60.0)}, limit_s=0.01)
    work.run()
    assert not isinstance(work.error, CanceledError)
    assert isinstance(work.error, CleaveError)
    assert "raise the time limit in the preferences" in str(work.error)


def test_results_that_were_not_used_for_longest_are_forgotten() -> None:
    cache = Cache(limit=10)
    for key in "abc":
        cache.put(key, key.upper(), 4)
    assert cache["a"] == "A"
    cache.trim()
    assert [key for key in "abc" if key in cache] == ["a", "c"]
    cache.discard("a")
    cache.discard("never there")
    assert "a" not in cache
    cache.clear()
    with pytest.raises(KeyError):
        cache["c"]
