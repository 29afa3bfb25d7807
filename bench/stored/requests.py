"""Measures requests to an installation with many stored jobs."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx

from bench.load.installation import installed_in
from bench.load.meshes import wavy_torus
from bench.stored.cost import Cost, cost_of
from bench.stored.filling import OWNERS, Filled
from service.keys import key_digest
from worker.jobs.store.layout import entry_name

_KEY = "cleave_measured"
_RUNS = 100


def request_costs(data_dir: Path, filled: Filled) -> Iterator[tuple[str, Cost]]:
    """Yield the cost of each request to the process of the service, of which no worker takes the submitted jobs."""
    mesh, samples = wavy_torus(500), filled.samples
    with _serving(data_dir) as (client, pid):

        def listed(**query: str) -> None:
            client.get("/v1/jobs", params=query).raise_for_status()

        def submit(seed: int) -> None:
            query = {"parameters": json.dumps({"seed": seed})}
            client.post(
                "/v1/jobs", content=mesh, params=query, headers={"Content-Type": "model/ply"}
            ).raise_for_status()

        def cost(operation: Callable[[int], object]) -> Cost:
            return cost_of(operation, _RUNS, pid)

        yield "first page of jobs", cost(lambda _: listed())
        for sample in samples:  # a small store is in the caches of the system anyway
            listed(cursor=entry_name(sample))
        yield "a later page", cost(lambda run: listed(cursor=entry_name(samples[run % len(samples)])))
        yield "first page, one status", cost(lambda _: listed(status="failed"))
        yield "a job", cost(lambda run: client.get(f"/v1/jobs/{samples[run % len(samples)].id}").raise_for_status())
        yield "submission", cost(lambda run: submit(2_000_000 + run))
        known = samples[0].parameters["seed"]
        yield "submission, stored result", cost(lambda _: submit(known))


@contextmanager
def _serving(data_dir: Path) -> Iterator[tuple[httpx.Client, int]]:
    settings = {"CLEAVE_LOG_LEVEL": "error", "CLEAVE_API_KEYS": f"{OWNERS[0]}:{key_digest(_KEY)}"}
    with installed_in(data_dir, 0, settings) as installation:
        headers = {"Authorization": f"Bearer {_KEY}"}
        with httpx.Client(base_url=installation.url, timeout=600, headers=headers) as client:
            yield client, installation.service_pid()
