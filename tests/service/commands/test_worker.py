"""`cleave worker --check`: the exit status reports if workers of this machine are alive."""

import socket
from pathlib import Path

import pytest
from redis import Redis

from helpers.queue_servers import StartServer
from service.commands.main import main


def test_only_workers_of_this_machine_count(
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
