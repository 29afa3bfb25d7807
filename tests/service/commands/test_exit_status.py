"""Each exit status that is documented is one that the command returns."""

import io
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from redis import Redis

from helpers.queue_servers import StartServer
from service.commands.main import COMMANDS, EXIT_STATUSES, INTERRUPTED, main
from worker.jobs.size_class import SizeClass

CLEAVE = (sys.executable, "-m", "service.commands")
NOWHERE = "redis://127.0.0.1:1/0"
# Arguments by command and status. Submit and the ends of serve and worker by a signal have tests of their own below.
CALLS = {
    ("serve", 2): ["--host", "192.0.2.1"],
    ("worker", 1): ["--check", "--redis-url", NOWHERE],
    ("worker", 2): [],
    ("segment", 0): ["ball.off"],
    ("segment", 2): ["missing.off"],
    ("edit", 0): ["ball.cleave", "--operations", "edits.json"],
    ("edit", 2): ["ball.cleave", "--operations", "missing.json"],
    ("convert", 0): ["ball.cleave", "-o", "ball.glb"],
    ("convert", 2): ["ball.off", "-o", "ball.glb"],
    ("inspect", 0): ["ball.off"],
    ("inspect", 2): ["ball.off", "--unit", "milimeter"],
    ("mcp", 0): ["--server", "http://127.0.0.1:1"],  # the standard input has ended
    ("mcp", 2): ["--data-dir", "ball.off"],
    ("key", 0): ["anna"],
    ("key", 2): ["Anna Smith"],
    ("doctor", 0): [],
    ("doctor", 1): ["--data-dir", "ball.off"],
    ("doctor", 2): [],
    ("completion", 0): ["bash"],
    ("completion", 2): ["fish"],
}
BY_SIGNAL = {("serve", 0), ("worker", 0)}
SUBMIT = {("submit", 0), ("submit", 1), ("submit", 2)}


def status_of(*arguments: str) -> int:
    try:
        return main(arguments)
    except SystemExit as ended:  # of argparse
        return int(ended.code or 0)


def test_every_documented_status_is_tested_here() -> None:
    documented = {(name, status) for name, statuses in EXIT_STATUSES.items() for status in statuses}
    assert set(EXIT_STATUSES) == set(COMMANDS)
    assert {*CALLS, *BY_SIGNAL, *SUBMIT} == documented


@pytest.mark.parametrize(("command", "status"), CALLS)
def test_a_command_ends_with_its_status(
    ball: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str, status: int
) -> None:
    for file in ball.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    (tmp_path / "edits.json").write_text('{"operations": [{"op": "lock", "part": 0}]}')
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CLEAVE_REDIS_URL", raising=False)
    monkeypatch.setenv("CLEAVE_DATA_DIR", str(tmp_path / "data"))
    if (command, status) == ("doctor", 2):
        monkeypatch.setenv("CLEAVE_MAX_FACES", "many")
    if command in ("serve", "worker", "mcp"):  # which configure the log or the signals of the process
        words = [*CLEAVE, command, *CALLS[command, status]]
        assert subprocess.run(words, stdin=subprocess.DEVNULL, check=False).returncode == status
    else:
        assert status_of(command, *CALLS[command, status]) == status


def test_submit_ends_with_its_statuses(url: str, mesh: Path, tmp_path: Path) -> None:
    options = ["--results", "seg", "-o", str(tmp_path / "out")]
    assert status_of("submit", str(mesh), "--server", url, *options) == 0
    assert status_of("submit", str(mesh), str(tmp_path / "missing.off"), "--server", url, *options) == 1
    assert status_of("submit", str(mesh), "--server", url, "-o", str(mesh)) == 2


@pytest.mark.parametrize("command", ["segment", "convert", "inspect"])
def test_ctrl_c_ends_a_command_with_130(monkeypatch: pytest.MonkeyPatch, command: str, tmp_path: Path) -> None:
    class Interrupted(io.BytesIO):
        def read(self, *_: object) -> bytes:
            signal.raise_signal(signal.SIGINT)
            return b""

    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(Interrupted()))
    output = ["-o", str(tmp_path / "a.glb")] if command == "convert" else []
    assert status_of(command, "-", *output) == INTERRUPTED


@pytest.mark.parametrize(("command", "number"), [("serve", signal.SIGINT), ("worker", signal.SIGTERM)])
def test_a_signal_ends_the_processes_of_an_installation_with_0(
    start_server: StartServer, tmp_path: Path, command: str, number: signal.Signals
) -> None:
    options = {"serve": ["--port", "0", "--workers", "0"], "worker": ["--workers", "1"]}[command]
    url = start_server()
    process = subprocess.Popen(
        [*CLEAVE, command, *options],
        env=os.environ
        | {"CLEAVE_REDIS_URL": url, "CLEAVE_DATA_DIR": str(tmp_path / "data"), "CLEAVE_SHUTDOWN_GRACE_S": "0.5"},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    process.stdout.readline()  # of the announcement
    process.send_signal(number)
    assert process.wait(60) == 0
    process.stdout.close()


def test_workers_that_are_alive_are_status_0(start_server: StartServer, tmp_path: Path) -> None:
    url, name = start_server(), f"{socket.gethostname()}.7.abc"
    with Redis.from_url(url) as connection:
        connection.sadd(f"rq:workers:cleave:{SizeClass.SMALL}", f"rq:worker:{name}")
        connection.set(f"rq:worker:{name}", "alive")
    assert status_of("worker", "--check", "--redis-url", url, "--data-dir", str(tmp_path)) == 0


def test_the_help_names_the_statuses(capsys: pytest.CaptureFixture[str]) -> None:
    for name, statuses in EXIT_STATUSES.items():
        assert status_of(name, "--help") == 0
        text = capsys.readouterr().out
        for status, meaning in statuses.items():
            assert f"  {status:<4} {meaning}\n" in text
