"""An installation on hosts that share the queue and the store but no disk; one host loses its network in mid-job."""

import json
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import httpx
import pytest
from redis import Redis

from helpers.buckets import CREDENTIALS
from helpers.hosts import Host, Network, can_make_hosts
from helpers.jobs import LONG, sphere, unfinished
from helpers.waiting import wait_until
from service.host.queue_server import find_server_binary
from worker.jobs.queue.workers import live_workers
from worker.jobs.store.opening import open_url
from worker.jobs.store.store import JobStore

pytestmark = pytest.mark.skipif(not can_make_hosts(), reason="network namespaces need the rights of root")

CLEAVE = [sys.executable, "-m", "service.commands"]
JOBS = 6


@dataclass(frozen=True, slots=True)
class Site:
    url: str  # of the service
    redis_url: str
    store_url: str
    workers: list[Host]


@pytest.fixture
def site(monkeypatch: pytest.MonkeyPatch) -> Iterator[Site]:
    """A queue server and a bucket on one host, the service on another one, and workers on three others."""
    with Network() as network:
        hub = network.hub.address
        redis_url, bucket = f"redis://:secret@{hub}:6379/0", f"http://{hub}:5000"
        store_url = f"s3://cleave/jobs?endpoint={bucket}"
        queue = {
            "bind": hub,
            "protected-mode": "no",
            "requirepass": "secret",
            "dir": str(network.hub.folder),
            "save": "",
        }
        words = [word for name, value in queue.items() for word in (f"--{name}", value)]
        network.hub.start([str(find_server_binary()), *words])
        network.hub.start([sys.executable, "-m", "moto.server", "-H", hub, "-p", "5000"], **CREDENTIALS)
        for name, value in CREDENTIALS.items():
            monkeypatch.setenv(name, value)
        settings = {
            "CLEAVE_REDIS_URL": redis_url,
            "CLEAVE_STORE_URL": store_url,
            "CLEAVE_LEASE_S": "3",
            "CLEAVE_AUTH": "off",
        }
        settings |= {"CLEAVE_LOG_LEVEL": "error", "CLEAVE_SHUTDOWN_GRACE_S": "0", "no_proxy": "*"}
        wait_until(lambda: is_answered(f"{bucket}/moto-api/"))
        httpx.put(f"{bucket}/cleave").raise_for_status()
        service = network.add_host("service")
        start(service, ["serve", "--host", service.address, "--workers", "0"], settings)
        workers = [network.add_host(f"worker{number}") for number in range(3)]
        for worker in workers:
            start(worker, ["worker", "--queue", "small", "--workers", "1"], settings)
        url = f"http://{service.address}:8000"
        wait_until(lambda: is_answered(f"{url}/healthz"))
        with Redis.from_url(redis_url) as connection:
            wait_until(lambda: len(live_workers(connection)) == len(workers))
        yield Site(url, redis_url, store_url, workers)


def start(host: Host, arguments: list[str], settings: dict[str, str]) -> None:
    host.start([*CLEAVE, *arguments], **settings, CLEAVE_DATA_DIR=str(host.folder / "data"))


def is_answered(url: str) -> bool:
    try:
        return httpx.get(url, timeout=5).status_code == 200
    except httpx.TransportError:
        return False


def submit(site: Site, mesh: bytes, **parameters: int) -> str:
    files, data = {"mesh": ("mesh.off", mesh)}, {"parameters": json.dumps(parameters)}
    headers = {"Cache-Control": "no-cache"}
    answer = httpx.post(f"{site.url}/v1/jobs", files=files, data=data, headers=headers, timeout=60)
    assert answer.status_code in (200, 202), answer.text  # 200: the job has ended already
    return str(answer.headers["Location"])


def statuses(site: Site, paths: list[str]) -> Counter[str]:
    return Counter(httpx.get(site.url + path, timeout=60).json()["status"] for path in paths)


def holders(site: Site, path: str) -> list[Host]:
    """Return the host whose worker has the lease of a job; the name of a worker contains its process id."""
    with Redis.from_url(site.redis_url) as connection:
        name = connection.get(f"cleave:lease:{id_of(path)}")
    return [host for host in site.workers if name and int(name.decode().split(".")[-2]) in host.tree()]


def id_of(path: str) -> str:
    return path.rpartition("/")[2]


def test_a_host_that_loses_its_network_loses_no_job_and_works_again_afterwards(
    site: Site, tmp_path_factory: pytest.TempPathFactory
) -> None:
    interrupted = submit(site, sphere(100), **LONG)
    wait_until(lambda: httpx.get(site.url + interrupted, timeout=60).json()["stage"])
    (cut_off,) = holders(site, interrupted)
    cut_off.unplug()
    others = [submit(site, sphere(40)) for _ in range(JOBS)]
    paths = [interrupted, *others]
    wait_until(lambda: statuses(site, paths) == {"succeeded": len(paths)})  # on the other hosts
    cut_off.plug_in()
    with Redis.from_url(site.redis_url) as connection:
        wait_until(lambda: len(live_workers(connection)) == len(site.workers))
    others += [submit(site, sphere(40)) for _ in range(3)]
    wait_until(lambda: statuses(site, others) == {"succeeded": len(others)})
    store = open_url(site.store_url, tmp_path_factory.mktemp("data"), 0)
    assert [attempt.number for attempt in store.records.attempts(id_of(interrupted))] == [1, 2]
    assert {len(store.records.attempts(id_of(path))) for path in others} == {1}
    assert len({result_bytes(store, path) for path in others}) == 1
    assert unfinished(store) == {}


def result_bytes(store: JobStore, path: str) -> bytes:
    with store.results.open(id_of(path)) as result:
        return result.read()
