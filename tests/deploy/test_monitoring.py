"""The dashboard and the alerts query existing metrics by existing labels."""

import json
import re
from pathlib import Path

import pytest
import yaml
from redis import Redis

from helpers.jobs import accepted
from service.telemetry.metrics import Metrics
from worker.jobs.job import Failed, Succeeded, now
from worker.jobs.queue.counters import JobCounters, Stored
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore

FOLDER = Path(__file__).parents[2] / "deploy"
DASHBOARD = json.loads((FOLDER / "grafana" / "cleave.json").read_text())
RULES = yaml.safe_load((FOLDER / "prometheus" / "alerts.yml").read_text())["groups"][0]["rules"]
QUERIES = [target["expr"] for panel in DASHBOARD["panels"] for target in panel.get("targets", [])]
QUERIES += [rule["expr"] for rule in RULES]


@pytest.fixture
def labels_of(store: JobStore, queue: JobQueue, connection: Redis, tmp_path: Path) -> dict[str, set[str]]:
    """Return the labels of every metric, of an installation in which each event has happened once."""
    job, counters = accepted(store, b"mesh"), JobCounters(connection)
    queue.take(job.id, "worker", lease_s=30)
    done = Succeeded(finished_at=now(), faces=1, vertices=3, max_segments=1, automatic_segments=1)
    counters.job_ended(job, done, {"cut": 1.0})
    counters.job_ended(job, Failed(finished_at=now(), code="invalid_mesh", message="."), {})
    counters.attempt_lost("worker_lost")
    counters.job_recovered()
    counters.store_failed("worker")
    counters.jobs_counted(Stored(1, 4))
    metrics = Metrics(store, queue, tmp_path)
    metrics.requests.labels("GET", "/", 200).inc()
    metrics.seconds.labels("/").observe(1.0)
    metrics.jobs.labels("accepted").inc()
    found: dict[str, set[str]] = {}
    for family in metrics.registry.collect():
        for sample in family.samples:
            found.setdefault(sample.name, set()).update(sample.labels)
    return found


@pytest.mark.parametrize("query", QUERIES)
def test_every_query_uses_existing_metrics_and_labels(query: str, labels_of: dict[str, set[str]]) -> None:
    names = re.findall(r"\bcleave_\w+", query)
    assert names
    assert set(names) <= set(labels_of)
    queried = {label.strip() for group in re.findall(r"by \(([^)]*)\)", query) for label in group.split(",")}
    queried |= {
        label for selector in re.findall(r"{([^}]*)}", query) for label in re.findall(r"(\w+)\s*(?:=|!)", selector)
    }
    assert queried <= set().union(*(labels_of[name] for name in names))
    assert query.count("(") == query.count(")")


def test_metrics_that_every_service_reports_are_not_summed_over_services(labels_of: dict[str, set[str]]) -> None:
    own = (
        "cleave_requests",
        "cleave_request_seconds",
        "cleave_jobs_submitted",
        "cleave_upload_bytes",
        "cleave_store_errors",
    )
    assert labels_of
    for query in QUERIES:
        for inner in re.findall(r"sum(?: by \([^)]*\))? ?\((?:rate|increase)?\(?(cleave_\w+)", query):
            assert inner.startswith(own), query


def test_the_dashboard_shows_every_metric_and_its_panels_do_not_overlap(labels_of: dict[str, set[str]]) -> None:
    shown = {
        re.sub(r"_(bucket|count|sum)$", "", name) for query in QUERIES for name in re.findall(r"\bcleave_\w+", query)
    }
    ours = [name for name in labels_of if name.startswith("cleave_")]
    there = {re.sub(r"_(bucket|count|sum)$", "", name) for name in ours}
    assert shown == {name for name in there if f"{name}_total" not in there}
    occupied: set[tuple[int, int]] = set()
    for place in (panel["gridPos"] for panel in DASHBOARD["panels"]):
        cells = {(place["x"] + x, place["y"] + y) for x in range(place["w"]) for y in range(place["h"])}
        assert not cells & occupied
        occupied |= cells
    assert len({panel["id"] for panel in DASHBOARD["panels"]}) == len(DASHBOARD["panels"])


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule["alert"])
def test_every_alert_has_a_severity_a_summary_and_a_description(rule: dict[str, dict[str, str]]) -> None:
    assert rule["labels"]["severity"] in ("critical", "warning")
    assert set(rule["annotations"]) == {"summary", "description"}
    assert all(text.endswith(".") for text in rule["annotations"].values())
