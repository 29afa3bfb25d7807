"""Which store the settings name, and what is said of a name that is none."""

import sys
from datetime import timedelta
from pathlib import Path

import pytest

from cleave.settings import InvalidSettings, Settings, load_settings
from worker.jobs.objects.buckets import open_bucket
from worker.jobs.store.opening import open_store


def test_without_a_url_the_data_folder_is_the_store(tmp_path: Path) -> None:
    assert open_store(Settings(data_dir=tmp_path)).objects.survives_fork
    assert open_store(Settings(data_dir=tmp_path)).results.presigned_url("0" * 32, 60) is None


@pytest.mark.parametrize(
    "url", ["s3://bucket?colour=red", "gs://bucket?endpoint=http://here", "s3:///prefix", "http://bucket/prefix"]
)
def test_a_url_that_is_none_of_a_bucket_is_refused(url: str) -> None:
    with pytest.raises(InvalidSettings, match="CLEAVE_STORE_URL"):
        open_bucket(url)


def test_a_store_in_the_memory_of_a_process_is_none_for_an_installation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLEAVE_STORE_URL", "memory://")
    with pytest.raises(InvalidSettings, match="CLEAVE_STORE_URL is 'memory://'"):
        load_settings()


def test_what_is_missing_for_buckets_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in ("obstore", "worker.jobs.objects.buckets", "worker.jobs.objects.remote"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(InvalidSettings, match=r"cleave-mesh\[cloud\]"):
        open_store(Settings(data_dir=tmp_path, store_url="s3://bucket"))


def test_an_address_for_others_can_have_another_host(s3_url: str) -> None:
    del s3_url  # the credentials
    for url, host in (
        (
            "s3://bucket/jobs?endpoint=http://inside:1&public_endpoint=https://outside",
            "https://outside/bucket/jobs/key?",
        ),
        ("s3://bucket/jobs?endpoint=http://inside:1", "http://inside:1/bucket/jobs/key?"),
    ):
        address = open_bucket(url).sign("key", timedelta(seconds=60))
        assert address is not None
        assert address.startswith(host)
