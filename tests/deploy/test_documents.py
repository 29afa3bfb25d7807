"""The documents for operators name existing settings, metrics, errors and tests."""

import re
from pathlib import Path

import pytest
import yaml

from cleave.settings import Settings
from service.problems import STATUS
from service.telemetry.metrics import Metrics
from worker.jobs.queue.counters import JobCounters, Stored
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore

ROOT = Path(__file__).parents[2]
OPERATIONS = (ROOT / "docs" / "how-to" / "operations.md").read_text()
SECURITY = (ROOT / "docs" / "explanation" / "security.md").read_text()
OF_COMPOSE = {"CLEAVE_REDIS_PASSWORD", "CLEAVE_STORE_PASSWORD"}


@pytest.mark.parametrize("text", [OPERATIONS, SECURITY], ids=["operations", "security"])
def test_every_setting_that_is_named_exists(text: str) -> None:
    known = {f"CLEAVE_{name.upper()}" for name in Settings.model_fields} | OF_COMPOSE
    assert set(re.findall(r"\bCLEAVE_[A-Z_]+\b", text)) <= known


def test_exactly_the_existing_metrics_are_explained(store: JobStore, queue: JobQueue, tmp_path: Path) -> None:
    JobCounters(queue.connection).jobs_counted(Stored(0, 0))
    ending = {"counter": "_total", "info": "_info"}
    there = {
        f"{family.name}{ending.get(family.type, '')}"
        for family in Metrics(store, queue, tmp_path).registry.collect()
        if family.name.startswith("cleave_")
    }
    rows = [line for line in OPERATIONS.splitlines() if line.startswith("| `cleave_")]
    assert {name for row in rows for name in re.findall(r"`(cleave_\w+)", row)} == there


def test_every_error_that_is_explained_exists() -> None:
    named = re.findall(r"^\| (\d{3}) `(\w+)`", OPERATIONS, re.MULTILINE)
    assert named
    assert all(STATUS[code] == int(status) for status, code in named)


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`(tests/[\w/]+\.py(?:::\w+)?)`", SECURITY))))
def test_every_claim_of_the_security_document_names_an_existing_test(name: str) -> None:
    file, _, function = name.partition("::")
    assert f"def {function}" in (ROOT / file).read_text()


def test_the_names_in_the_configuration_of_traefik_refer_to_each_other() -> None:
    http = yaml.safe_load((ROOT / "deploy" / "proxies" / "traefik.yml").read_text())["http"]
    static = yaml.safe_load((ROOT / "deploy" / "proxies" / "traefik-static.yml").read_text())
    (router,) = http["routers"].values()
    assert set(router["entryPoints"]) < set(static["entryPoints"])
    assert router["tls"]["certResolver"] in static["certificatesResolvers"]
    assert static["entryPoints"]["web"]["http"]["redirections"]["entryPoint"]["to"] in static["entryPoints"]
    assert router["service"] in http["services"]
    assert set(router["middlewares"]) == set(http["middlewares"])
    (prefix,) = http["middlewares"][router["middlewares"][0]]["stripPrefix"]["prefixes"]
    assert router["rule"].endswith(f"PathPrefix(`{prefix}`)")
