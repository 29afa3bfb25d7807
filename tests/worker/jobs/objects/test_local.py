"""Objects in a folder: listings read few folders, and a file may have as many names as are wanted."""

import errno
import os
from pathlib import Path

import pytest

from helpers.storage.counting import counting
from worker.jobs.objects.local import LocalObjects

KEYS = sorted(f"a/{day}/{minute}/{number}" for day in "37" for minute in ("05", "5", "50") for number in range(3))


@pytest.fixture
def objects(tmp_path: Path) -> LocalObjects:
    objects = LocalObjects(tmp_path)
    for key in reversed(KEYS):
        objects.put(key, b"")
    return objects


def test_keys_are_listed_in_order_after_any_key(objects: LocalObjects) -> None:
    for after in ("", *KEYS, "a/3/05", "a/3/05/", "a/4", "a/3/5", "b"):
        following = [key for key in KEYS if key > after]
        for limit in (None, 0, 1, 4, 100):
            assert objects.keys_below("a", after, limit) == following[:limit]
        assert [one.key for one in objects.list_below("a", after)] == following
    assert sorted(objects.walk("a")) == KEYS
    assert objects.keys_below("nowhere") == list(objects.walk("nowhere")) == []


def test_a_short_list_reads_few_names(objects: LocalObjects, monkeypatch: pytest.MonkeyPatch) -> None:
    counted = counting(monkeypatch)
    assert objects.keys_below("a", KEYS[8], 1) == [KEYS[9]]
    assert counted.names <= 2 + 3 + 3 + 3 + 3


def test_folders_are_removed_with_their_last_object(objects: LocalObjects, tmp_path: Path) -> None:
    for key in KEYS[:9]:
        objects.delete(key)
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["7"]
    for key in KEYS[9:]:
        objects.delete(key)
    assert list((tmp_path / "a").iterdir()) == []
    objects.delete("nothing")


def test_a_file_that_has_too_many_names_is_copied(objects: LocalObjects, monkeypatch: pytest.MonkeyPatch) -> None:
    objects.put("jobs/1/result", b"bytes")
    objects.copy("jobs/1/result", "jobs/2/result")

    def refuse(*_: object) -> None:
        raise OSError(errno.EMLINK, "Too many links")

    monkeypatch.setattr(os, "link", refuse)
    objects.copy("jobs/1/result", "jobs/3/result")
    assert [objects.get(f"jobs/{number}/result") for number in (2, 3)] == [b"bytes", b"bytes"]


def test_objects_that_are_made_durable_later_may_be_deleted_meanwhile(objects: LocalObjects) -> None:
    objects.put("b/1/1", b"", durable=False)
    objects.put("b/1/2", b"text", durable=False)
    objects.delete("b/1/1")
    objects.sync(["b/1/1", "b/1/2", "c/d"])
    assert objects.keys_below("b") == ["b/1/2"]
