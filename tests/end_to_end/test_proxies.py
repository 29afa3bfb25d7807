"""The service below a path of nginx and of Caddy, with the configurations of docs/how-to/proxies.md."""

import os
import re
import shutil
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from bench.day.proxies import caddy, nginx, proxied
from helpers.api import AGAIN
from helpers.installation import Installation
from helpers.jobs import sphere
from helpers.waiting import wait_until


@pytest.fixture(scope="module")
def installation() -> Iterator[Installation]:
    with Installation(workers=1) as running:
        yield running


@pytest.fixture(params=[nginx, caddy], ids=["nginx", "caddy"])
def url(request: pytest.FixtureRequest, installation: Installation, tmp_path: Path) -> Iterator[str]:
    if shutil.which(request.param.__name__) is None and "CI" not in os.environ:
        pytest.skip(f"the test needs {request.param.__name__}")
    with proxied(request.param, tmp_path, installation.url) as shown:
        yield shown


def test_a_job_runs_through_the_proxy_and_every_link_leads_to_it(url: str) -> None:
    root = url.removesuffix("/cleave")
    mesh = sphere(120)
    assert len(mesh) > 1_500_000  # more than nginx takes by default
    with httpx.Client(base_url=root, timeout=60) as client:
        answer = client.post("/cleave/v1/jobs?segments=3", files={"mesh": ("mesh.off", mesh)}, headers=AGAIN)
        assert answer.status_code == 202
        path = answer.headers["Location"]
        assert path.startswith("/cleave/v1/jobs/")
        wait_until(lambda: client.get(path).json()["status"] == "succeeded")
        links = client.get(path).json()["links"]
        for name, link in links.items():
            if name not in ("cancel", "events", "edits"):
                assert client.get(link).status_code == 200, link
        assert client.post(links["cancel"]).status_code == 409


def test_events_arrive_when_they_happen(url: str) -> None:
    with httpx.Client(base_url=url.removesuffix("/cleave"), timeout=60) as client:
        form = {"mesh": ("mesh.off", sphere(150))}
        job = client.post("/cleave/v1/jobs", files=form, headers=AGAIN).json()
        with client.stream("GET", job["links"]["events"]) as stream:
            assert stream.headers["Content-Type"].startswith("text/event-stream")
            arrived = [time.monotonic() for line in stream.iter_lines() if line.startswith("event:")]
    assert len(arrived) >= 3
    assert arrived[-1] - arrived[0] > 0.2  # buffered events would arrive together


def test_the_page_and_the_reference_load_all_their_files(url: str) -> None:
    with httpx.Client(follow_redirects=True, timeout=60) as client:
        for start in (url, f"{url}/", f"{url}/docs"):
            page = client.get(start)
            assert page.status_code == 200
            files = re.findall(r'(?:href|src)="([\w./-]+\.(?:js|css|svg|json))"', page.text)
            assert files
            for file in files:
                assert client.get(page.url.join(file)).status_code == 200, file
