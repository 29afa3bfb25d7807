"""The checks of the queue server find bad settings of real servers."""

import time

import pytest
from redis import Redis

from helpers.findings import severities
from helpers.queue_servers import StartServer
from service.doctor.queue_checks import check_queue
from worker.jobs.queue.queue import QUEUE_NAMES


def test_a_server_with_the_recommended_settings_has_no_findings(start_server: StartServer) -> None:
    url = start_server(requirepass="secret", appendonly="yes", maxmemory_policy="noeviction")
    with Redis.from_url(url) as connection:
        for name in QUEUE_NAMES.values():
            connection.sadd(f"rq:workers:{name}", f"rq:worker:{name}")
            connection.set(f"rq:worker:{name}", "alive")
    found = severities(check_queue(url))
    assert set(found.values()) == {"ok"}
    assert {"queue server's access", "queue server's memory", "queue server's disk", "workers"} <= set(found)


def test_eviction_missing_persistence_and_open_access_are_found(start_server: StartServer) -> None:
    url = start_server(maxmemory="10mb", maxmemory_policy="allkeys-lru", bind="0.0.0.0", protected_mode="no")
    found = severities(check_queue(url))
    assert found["queue server's memory"] == "error"
    assert found["queue server's access"] == "error"
    assert found["queue server's disk"] == "warning"
    assert found["workers"] == "error"
    assert found["queue server"] == "ok"


def test_a_missing_password_is_a_warning_if_only_this_machine_can_connect(start_server: StartServer) -> None:
    assert severities(check_queue(start_server(bind="127.0.0.1")))["queue server's access"] == "warning"


def test_a_stopped_server_and_a_wrong_password_are_found_quickly(start_server: StartServer) -> None:
    began_at = time.monotonic()
    down = check_queue("redis://127.0.0.1:1/0")
    wrong = check_queue(start_server(requirepass="secret").replace("secret", "guess"))
    assert severities(down) == severities(wrong) == {"queue server": "error"}
    assert time.monotonic() - began_at < 10
    assert "guess" not in str(wrong)


def test_a_clock_that_is_ahead_is_found(start_server: StartServer, monkeypatch: pytest.MonkeyPatch) -> None:
    url, true_time = start_server(), time.time
    monkeypatch.setattr(time, "time", lambda: true_time() - 60)
    (clock,) = [finding for finding in check_queue(url) if finding.topic == "queue server's clock"]
    assert clock.severity == "warning"
    assert "60 s ahead" in clock.message
