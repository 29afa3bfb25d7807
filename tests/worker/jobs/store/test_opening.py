"""The store that the settings name, and the errors if they name none."""

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
def test_a_url_that_is_not_that_of_a_bucket_is_refused(url: str) -> None:
    with pytest.raises(InvalidSettings, match="CLEAVE_STORE_URL"):
        open_bucket(url)


def test_an_installation_cannot_have_its_store_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLEAVE_STORE_URL", "memory://")
    with pytest.raises(InvalidSettings, match="CLEAVE_STORE_URL is 'memory://'"):
        load_settings()


def test_a_missing_optional_dependency_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in ("obstore", "worker.jobs.objects.buckets", "worker.jobs.objects.remote"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(InvalidSettings, match=r"cleave-mesh\[cloud\]"):
        open_store(Settings(data_dir=tmp_path, store_url="s3://bucket"))


def test_presigned_urls_have_the_host_of_the_public_endpoint(s3_url: str) -> None:
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
