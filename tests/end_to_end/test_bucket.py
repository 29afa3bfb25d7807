"""`cleave serve` with its jobs in a bucket: the data folder contains nothing that cannot be lost."""

import os
import subprocess
import sys
from pathlib import Path

import httpx

from helpers.buckets import below
from helpers.installation import Installation
from helpers.jobs import sphere
from helpers.waiting import wait_until
from worker.jobs.job import new_job_id
from worker.jobs.store.opening import open_url


def installation_in_bucket(url: str) -> Installation:
    installation = Installation(workers=1)
    installation.settings = Installation.settings | {"CLEAVE_STORE_URL": url}  # type: ignore[misc]
    return installation


def test_another_machine_serves_the_jobs_of_a_bucket(s3_url: str, tmp_path: Path) -> None:
    url = below(s3_url, new_job_id())
    with installation_in_bucket(url) as installation:
        path = installation.submit(sphere(20))
        wait_until(lambda: installation.status(path) == "succeeded")
        labels = installation.get(f"{path}/labels?segments=3").content
        assert installation.stop() == 0
        assert installation.files() == []
    with installation_in_bucket(url) as elsewhere:
        assert elsewhere.get(f"{path}/labels?segments=3").content == labels
        redirected = elsewhere.get(f"{path}/result.cleave?redirect=true")
        assert redirected.status_code == 307
        assert httpx.get(redirected.headers["Location"]).content == elsewhere.get(f"{path}/result.cleave").content
        assert httpx.delete(elsewhere.url + path).status_code == 204
        assert elsewhere.get(path).status_code == 410
    left = open_url(url, tmp_path, 0).objects.list_below("jobs")
    assert left == []


def test_a_missing_bucket_is_an_error_at_the_start(s3_url: str, tmp_path: Path) -> None:
    wrong = {"CLEAVE_STORE_URL": s3_url.replace("cleave-test", "no-such-bucket"), "CLEAVE_DATA_DIR": str(tmp_path)}
    command = [sys.executable, "-m", "service.commands", "serve", "--port", "0"]
    ended = subprocess.run(command, env=os.environ | wrong, capture_output=True, text=True)
    assert ended.returncode == 2
    assert "There is no such bucket" in ended.stderr
    assert "Traceback" not in ended.stderr
