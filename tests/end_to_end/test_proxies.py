"""The service behind nginx and Caddy, with the configurations of deploy/."""

import os
import re
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest

from bench.day.proxies import CADDY, CADDY_OF_COMPOSE, NGINX, PATH, Proxy, ProxyKind, proxied
from helpers.api import AGAIN
from helpers.installation import Installation
from helpers.jobs import sphere
from helpers.waiting import wait_until


@pytest.fixture(scope="module")
def installation() -> Iterator[Installation]:
    with Installation(workers=1) as running:
        yield running


@contextmanager
def running(kind: ProxyKind, installation: Installation, folder: Path) -> Iterator[Proxy]:
    if shutil.which(kind.program) is None and "CI" not in os.environ:
        pytest.skip(f"the test needs {kind.program}")
    with proxied(kind, folder, installation.url) as proxy:
        yield proxy


@pytest.fixture(params=[NGINX, CADDY], ids=["nginx", "caddy"])
def proxy(request: pytest.FixtureRequest, installation: Installation, tmp_path: Path) -> Iterator[Proxy]:
    with running(request.param, installation, tmp_path) as shown:
        yield shown


def client_of(proxy: Proxy) -> httpx.Client:
    return httpx.Client(base_url=proxy.url.removesuffix(PATH), timeout=60, verify=proxy.trust)


def test_a_job_runs_through_the_proxy_and_every_link_leads_to_it(proxy: Proxy) -> None:
    mesh = sphere(120)
    assert len(mesh) > 1_500_000  # more than nginx takes by default
    with client_of(proxy) as client:
        answer = client.post("/cleave/v1/jobs?segments=3", files={"mesh": ("mesh.off", mesh)}, headers=AGAIN)
        assert answer.status_code == 202
        path = answer.headers["Location"]
        assert path.startswith("/cleave/v1/jobs/")
        wait_until(lambda: client.get(path).json()["status"] == "succeeded")
        links = client.get(path).json()["links"]
        for name, link in links.items():
            if name not in ("cancel", "events", "edits"):
                quick = f"{link}?collision=hull" if name.startswith("robot") else link  # CoACD takes long
                assert client.get(quick).status_code == 200, link
        assert client.post(links["cancel"]).status_code == 409


def test_events_arrive_when_they_happen(proxy: Proxy) -> None:
    with client_of(proxy) as client:
        form = {"mesh": ("mesh.off", sphere(150))}
        job = client.post("/cleave/v1/jobs", files=form, headers=AGAIN).json()
        with client.stream("GET", job["links"]["events"]) as stream:
            assert stream.headers["Content-Type"].startswith("text/event-stream")
            arrived = [time.monotonic() for line in stream.iter_lines() if line.startswith("event:")]
    assert len(arrived) >= 3
    assert arrived[-1] - arrived[0] > 0.2  # buffered events would arrive together


def test_the_page_and_the_reference_load_all_their_files(proxy: Proxy) -> None:
    with client_of(proxy) as client:
        for start in ("", "/", "/docs"):
            page = client.get(f"{PATH}{start}", follow_redirects=True)
            assert page.status_code == 200
            files = re.findall(r'(?:href|src)="([\w./-]+\.(?:js|css|svg|json))"', page.text)
            assert files
            for file in files:
                assert client.get(page.url.join(file)).status_code == 200, file


def test_requests_without_tls_are_redirected(proxy: Proxy) -> None:
    answer = httpx.get(f"{proxy.plain_url}/docs")
    assert answer.status_code in (301, 308)
    target = httpx.URL(answer.headers["Location"])
    assert (target.scheme, target.host, target.path) == ("https", "localhost", f"{PATH}/docs")


def test_the_proxy_of_compose_shows_the_service_at_the_root_of_its_host(
    installation: Installation, tmp_path: Path
) -> None:
    with running(CADDY_OF_COMPOSE, installation, tmp_path) as proxy, client_of(proxy) as client:
        form = {"mesh": ("mesh.off", sphere(20))}
        job = client.post("/v1/jobs", files=form, headers=AGAIN).json()
        assert job["links"]["self"] == f"/v1/jobs/{job['id']}"
        assert client.get(job["links"]["self"]).status_code == 200
