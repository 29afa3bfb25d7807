"""The file cache: a file is downloaded once, and the size limit is kept."""

import io
import os
from pathlib import Path
from typing import BinaryIO

import pytest

from worker.jobs.objects.file_cache import FileCache


class Bucket:
    """A bucket that records which files are fetched."""

    def __init__(self) -> None:
        self.fetched: list[str] = []

    def fetch(self, name: str) -> BinaryIO:
        self.fetched.append(name)
        return io.BytesIO(name.encode() * 10)


def read(cache: FileCache, bucket: Bucket, name: str) -> bytes:
    with cache.open(name, lambda: bucket.fetch(name)) as file:
        return file.read()


def test_a_file_is_fetched_once(tmp_path: Path) -> None:
    bucket = Bucket()
    for cache in (FileCache(tmp_path, 100), FileCache(tmp_path, 100)):
        assert read(cache, bucket, "a") == b"a" * 10
    assert bucket.fetched == ["a"]
    cache.drop("a")
    cache.drop("a")
    assert read(cache, bucket, "a") == b"a" * 10
    assert bucket.fetched == ["a", "a"]


def test_the_least_recently_used_file_is_removed_first(tmp_path: Path) -> None:
    cache, bucket = FileCache(tmp_path, 25), Bucket()
    for age, name in ((30, "a"), (20, "b")):
        read(cache, bucket, name)
        os.utime(tmp_path / name, (tmp_path.stat().st_mtime - age,) * 2)
    read(cache, bucket, "a")
    read(cache, bucket, "c")
    assert {path.name for path in tmp_path.iterdir()} == {"a", "c"}


@pytest.mark.parametrize("max_bytes", [0, 9])
def test_a_file_above_the_size_limit_is_returned_but_not_cached(tmp_path: Path, max_bytes: int) -> None:
    assert read(FileCache(tmp_path, max_bytes), Bucket(), "a") == b"a" * 10
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_was_not_used_for_an_hour_is_removed(tmp_path: Path) -> None:
    cache, bucket = FileCache(tmp_path, 10**6), Bucket()
    read(cache, bucket, "a")
    os.utime(tmp_path / "a", (0, 0))
    read(cache, bucket, "b")
    assert [path.name for path in tmp_path.iterdir()] == ["b"]
