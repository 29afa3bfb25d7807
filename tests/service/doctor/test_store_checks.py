"""The checks of the store and the data folder."""

import re
from pathlib import Path

import pytest

from cleave.settings import Settings
from helpers.findings import severities
from service.doctor.store_checks import check_store
from worker.jobs.objects.interface import ObjectInfo
from worker.jobs.objects.local import LocalObjects


def test_a_store_that_cannot_be_written_is_found(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("a file, not a folder")
    assert severities(check_store(Settings(data_dir=tmp_path / "data")))["store"] == "error"


def test_a_bucket_is_checked_too(tmp_path: Path, s3_url: str) -> None:
    found = severities(check_store(Settings(data_dir=tmp_path, store_url=s3_url)))
    assert (found["store"], found["store's clock"]) == ("ok", "ok")
    gone = severities(check_store(Settings(data_dir=tmp_path, store_url=re.sub(r":\d+$", ":1", s3_url))))
    assert gone["store"] == "error"


def test_a_full_disk_and_a_folder_that_others_can_read_are_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = Settings(data_dir=tmp_path, max_upload_bytes=2**40)
    tmp_path.chmod(0o755)
    found = severities(check_store(settings))
    assert (found["disk"], found["data folder"], found["store"], found["store's clock"]) == (
        "error",
        "warning",
        "ok",
        "ok",
    )
    tmp_path.chmod(0o700)
    usage = type("Usage", (), {"free": 2**42})
    monkeypatch.setattr("shutil.disk_usage", lambda _: usage)
    found = severities(check_store(settings))
    assert (found["disk"], found["data folder"]) == ("warning", "ok")


def test_the_clock_of_the_store_is_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    true_list = LocalObjects.list_below

    def list_late(objects: LocalObjects, folder: str) -> list[ObjectInfo]:
        found = true_list(objects, folder)
        return [ObjectInfo(one.key, one.size_bytes, one.modified_at - 3600) for one in found]

    monkeypatch.setattr(LocalObjects, "list_below", list_late)
    found = {finding.topic: finding for finding in check_store(Settings(data_dir=tmp_path))}
    assert "3600 s behind" in found["store's clock"].message
    assert not list((tmp_path / "probe").glob("*"))
