"""`cleave doctor` finds what would break an installation and says what to do, with real servers of bad settings."""

import json
import re
import resource
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from redis import Redis
from redis.exceptions import RedisError

from cleave.settings import Settings
from helpers.waiting import wait_until
from service.commands.main import main
from service.doctor.findings import Finding
from service.doctor.machine_checks import check_machine
from service.doctor.queue_checks import check_queue
from service.doctor.store_checks import check_store
from service.host.queue_server import find_server_binary
from worker.jobs.objects.interface import ObjectInfo
from worker.jobs.queue.queue import QUEUE_NAMES

StartServer = Callable[..., str]
LIMITS = ("open files", "file size", "memory", "memory of a job", "kernels", "settings")


@pytest.fixture
def start_server(tmp_path: Path) -> Iterator[StartServer]:
    """Start queue servers with options, on ports of their own; their URLs."""
    started: list[subprocess.Popen[bytes]] = []

    def start(**options: str) -> str:
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = str(free.getsockname()[1])
        given = {"port": port, "dir": str(tmp_path), "save": "", "logfile": str(tmp_path / "log")}
        words = [word for name, value in (given | options).items() for word in (f"--{name.replace('_', '-')}", value)]
        started.append(subprocess.Popen([str(find_server_binary()), *words]))
        password = options.get("requirepass")
        url = f"redis://:{password}@127.0.0.1:{port}/0" if password else f"redis://127.0.0.1:{port}/0"
        wait_until(lambda: answers(url))
        return url

    yield start
    for process in started:
        process.kill()
        process.wait()


def answers(url: str) -> bool:
    with Redis.from_url(url) as connection:
        try:
            return bool(connection.ping())
        except RedisError:
            return False


def severities(findings: list[Finding]) -> dict[str, str]:
    assert all((finding.fix is None) == (finding.severity == "ok") for finding in findings)
    assert all(finding.message.endswith(".") for finding in findings)
    order = ["ok", "warning", "error"]
    worst: dict[str, str] = {}
    for finding in findings:
        worst[finding.topic] = max(finding.severity, worst.get(finding.topic, "ok"), key=order.index)
    return worst


def test_a_server_as_it_should_be_is_found_well(start_server: StartServer) -> None:
    url = start_server(requirepass="secret", appendonly="yes", maxmemory_policy="noeviction")
    with Redis.from_url(url) as connection:
        for name in QUEUE_NAMES.values():
            connection.sadd(f"rq:workers:{name}", f"rq:worker:{name}")
            connection.set(f"rq:worker:{name}", "alive")
    found = severities(check_queue(url))
    assert set(found.values()) == {"ok"}
    assert {"queue server's access", "queue server's memory", "queue server's disk", "workers"} <= set(found)


def test_a_server_that_evicts_forgets_and_lets_everybody_in_is_found_out(start_server: StartServer) -> None:
    url = start_server(maxmemory="10mb", maxmemory_policy="allkeys-lru", bind="0.0.0.0", protected_mode="no")
    found = severities(check_queue(url))
    assert found["queue server's memory"] == "error"
    assert found["queue server's access"] == "error"
    assert found["queue server's disk"] == "warning"
    assert found["workers"] == "error"
    assert found["queue server"] == "ok"


def test_no_password_is_a_smaller_matter_where_only_this_machine_gets_at_it(start_server: StartServer) -> None:
    assert severities(check_queue(start_server(bind="127.0.0.1")))["queue server's access"] == "warning"


def test_a_server_that_is_down_and_a_wrong_password_are_said_at_once(start_server: StartServer) -> None:
    began_at = time.monotonic()
    down = check_queue("redis://127.0.0.1:1/0")
    wrong = check_queue(start_server(requirepass="secret").replace("secret", "guess"))
    assert severities(down) == severities(wrong) == {"queue server": "error"}
    assert time.monotonic() - began_at < 10
    assert "guess" not in str(wrong)


def test_a_clock_that_runs_ahead_is_found_out(start_server: StartServer, monkeypatch: pytest.MonkeyPatch) -> None:
    url, true_time = start_server(), time.time
    monkeypatch.setattr(time, "time", lambda: true_time() - 60)
    (clock,) = [finding for finding in check_queue(url) if finding.topic == "queue server's clock"]
    assert clock.severity == "warning"
    assert "60 s ahead" in clock.message


def test_a_store_that_cannot_be_written_is_found_out(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("a file, not a folder")
    assert severities(check_store(Settings(data_dir=tmp_path / "data")))["store"] == "error"


def test_a_bucket_is_looked_at_too(tmp_path: Path, s3_url: str) -> None:
    found = severities(check_store(Settings(data_dir=tmp_path, store_url=s3_url)))
    assert (found["store"], found["store's clock"]) == ("ok", "ok")
    gone = severities(check_store(Settings(data_dir=tmp_path, store_url=re.sub(r":\d+$", ":1", s3_url))))
    assert gone["store"] == "error"


def test_a_full_disk_and_a_folder_open_to_others_are_found_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    settings = Settings(data_dir=tmp_path, max_upload_bytes=2**40)
    tmp_path.chmod(0o755)
    found = severities(check_store(settings))
    assert (found["disk"], found["data folder"], found["store"], found["store's clock"]) == (
        "error",
        "warning",
        "ok",
        "ok",
    )
    tmp_path.chmod(0o700)
    usage = type("Usage", (), {"free": 2**42})
    monkeypatch.setattr("shutil.disk_usage", lambda _: usage)
    found = severities(check_store(settings))
    assert (found["disk"], found["data folder"]) == ("warning", "ok")


def test_the_clock_of_a_store_is_looked_at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from worker.jobs.objects.local import LocalObjects

    true_list = LocalObjects.list_below

    def list_late(objects: LocalObjects, folder: str) -> list[ObjectInfo]:
        found = true_list(objects, folder)
        return [ObjectInfo(one.key, one.size_bytes, one.modified_at - 3600) for one in found]

    monkeypatch.setattr(LocalObjects, "list_below", list_late)
    found = {finding.topic: finding for finding in check_store(Settings(data_dir=tmp_path))}
    assert "3600 s behind" in found["store's clock"].message
    assert not list((tmp_path / "probe").glob("*"))


def test_limits_of_the_machine_are_held_against_the_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    small = {resource.RLIMIT_NOFILE: 256, resource.RLIMIT_FSIZE: 1000}
    monkeypatch.setattr(resource, "getrlimit", lambda which: (small[which], small[which]))
    monkeypatch.setattr("service.doctor.machine_checks.memory_bytes", lambda: 2**30)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("CLEAVE_MAX_FACE", "7")
    found = {finding.topic: finding for finding in check_machine(Settings(data_dir=tmp_path), "127.0.0.1")}
    assert {topic: found[topic].severity for topic in LIMITS} == {
        "open files": "warning",
        "file size": "error",
        "memory": "warning",
        "memory of a job": "warning",
        "kernels": "warning",
        "settings": "warning",
    }
    assert "CLEAVE_MAX_FACES to 1373634" in str(found["memory"].fix)
    assert "CLEAVE_MAX_FACE is none" in found["settings"].message


@pytest.mark.parametrize(
    ("auth", "host", "severity"),
    [
        ("auto", "127.0.0.1", "ok"),
        ("auto", "0.0.0.0", "error"),
        ("off", "0.0.0.0", "warning"),
        ("required", "::1", "error"),
    ],
)
def test_who_is_let_in_is_looked_at(tmp_path: Path, auth: str, host: str, severity: str) -> None:
    settings = Settings.model_validate({"data_dir": tmp_path, "auth": auth})
    assert severities(check_machine(settings, host))["access"] == severity


def test_the_command_tells_people_programs_and_the_shell(
    start_server: StartServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CLEAVE_REDIS_URL", start_server())
    assert main(["doctor", "--data-dir", str(tmp_path)]) == 1
    text = capsys.readouterr().out
    assert "error    workers: none for small jobs is alive.\n         -> Start one: cleave worker --queue small" in text
    assert main(["doctor", "--data-dir", str(tmp_path), "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert document["healthy"] is False
    assert {finding["severity"] for finding in document["findings"]} == {"ok", "warning", "error"}


def test_without_a_server_there_is_advice_and_no_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("CLEAVE_REDIS_URL", raising=False)
    assert main(["doctor", "--data-dir", str(tmp_path / "data")]) == 0
    assert "Start `cleave serve`" in capsys.readouterr().out


def test_a_health_check_knows_the_workers_of_this_machine(
    start_server: StartServer, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    url = start_server()
    check = ["worker", "--check", "--redis-url", url, "--data-dir", str(tmp_path)]
    name = f"{socket.gethostname()}.7.abc"
    with Redis.from_url(url) as connection:
        for worker in (name, "elsewhere.7.abc"):
            connection.sadd("rq:workers:cleave:small", f"rq:worker:{worker}")
        connection.set("rq:worker:elsewhere.7.abc", "alive")
        assert main(check) == 1
        connection.set(f"rq:worker:{name}", "alive")
        assert main(check) == 0
    assert f"alive on this machine: {name}." in capsys.readouterr().out
    assert main(["worker", "--check", "--redis-url", "redis://127.0.0.1:1/0", "--data-dir", str(tmp_path)]) == 1
