"""A queue server that cannot be used is refused at the start, with the reason."""

from pathlib import Path

import pytest
from redis import Redis

from helpers.queue_servers import queue_servers
from service.commands.main import main
from worker.jobs.queue.requirements import unmet_requirement


def test_a_server_with_all_rights_meets_the_requirements_and_keeps_nothing(tmp_path: Path) -> None:
    with queue_servers(tmp_path) as start, Redis.from_url(start()) as connection:
        assert unmet_requirement(connection) is None
        assert connection.keys() == []


@pytest.mark.parametrize(
    ("rights", "named"),
    [
        ("+@all -info ~*", "INFO"),
        ("+@all -blmove -eval ~*", "BLMOVE, EVAL"),
        ("+@all -client|info ~*", "CLIENT INFO"),
        ("+@all ~cleave:*", "keys that begin with rq:"),
    ],
)
def test_missing_rights_are_named(tmp_path: Path, rights: str, named: str) -> None:
    with queue_servers(tmp_path) as start:
        url = start()
        with Redis.from_url(url) as connection:
            connection.execute_command("ACL", "SETUSER", "limited", "on", "nopass", *rights.split())
        with Redis.from_url(url.replace("//", "//limited:any@")) as limited:
            reason = unmet_requirement(limited)
    assert reason is not None
    assert f"may not use {named} on" in reason


@pytest.mark.parametrize("command", ["serve", "worker"])
def test_a_cluster_is_refused_at_the_start(
    tmp_path: Path, command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with queue_servers(tmp_path) as start:
        monkeypatch.setenv("CLEAVE_REDIS_URL", start(cluster_enabled="yes"))
        arguments = [command, "--data-dir", str(tmp_path / "data")]
        assert main([*arguments, "--port", "0"] if command == "serve" else arguments) == 2
    assert "is a Redis cluster, which rq cannot use" in capsys.readouterr().err


def test_the_doctor_names_the_missing_right(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with queue_servers(tmp_path) as start:
        url = start()
        with Redis.from_url(url) as connection:
            connection.execute_command("ACL", "SETUSER", "limited", "on", "nopass", "+@all", "-info", "~*")
        monkeypatch.setenv("CLEAVE_REDIS_URL", url.replace("//", "//limited:any@"))
        assert main(["doctor", "--data-dir", str(tmp_path)]) == 1
    assert "may not use INFO on the queue server.\n         -> Allow it" in capsys.readouterr().out
