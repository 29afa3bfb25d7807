"""The embedded queue server: its binary, its socket, and its persistence."""

import os
import re
import stat
import subprocess
from pathlib import Path

import pytest

from helpers.waiting import wait_until
from service.host import queue_server
from service.host.queue_server import NoQueueServer, embedded_queue_server, find_server_binary, socket_path, stop_orphan


def test_the_error_of_a_missing_binary_names_the_setting(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(queue_server, "_packaged_binary", lambda: None)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(NoQueueServer, match="CLEAVE_REDIS_URL"):
        find_server_binary()
    redis = tmp_path / "redis-server"
    redis.touch(mode=0o755)
    assert find_server_binary() == redis


def test_a_socket_path_is_never_too_long_for_the_kernel(tmp_path: Path) -> None:
    folder = tmp_path / ("long" * 30)
    path = socket_path(folder)
    assert len(os.fsencode(path)) <= 100
    assert path == socket_path(folder)
    assert path != socket_path(folder / "other")
    assert not path.parent.exists()  # nothing is made before a server starts


def test_the_folder_of_a_socket_elsewhere_is_private(tmp_path: Path) -> None:
    server = embedded_queue_server(tmp_path / ("long" * 30))
    assert stat.S_IMODE(server.socket.parent.stat().st_mode) == 0o700
    server.remove_socket()
    assert not server.socket.parent.exists()


@pytest.mark.parametrize("name", ["a b", "a=b", "it's", "50%", "a#b", "ümlaut", "a?b", "a&b"])
def test_a_socket_path_has_no_characters_that_urls_and_lists_of_clients_treat_specially(
    tmp_path: Path, name: str
) -> None:
    path = socket_path(tmp_path / name)
    assert path.parent != tmp_path / name
    assert re.fullmatch(r"[A-Za-z0-9/._+-]+", str(path))


def test_a_temporary_folder_with_a_blank_is_not_used_for_the_socket(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "my temp"))
    path = socket_path(tmp_path / "my data")
    assert path.parent.parent == Path("/tmp")


def test_a_folder_that_others_can_write_is_not_used_for_the_socket(tmp_path: Path) -> None:
    folder = tmp_path / ("long" * 30)
    short = embedded_queue_server(folder).socket.parent
    short.chmod(0o777)
    try:
        with pytest.raises(NoQueueServer, match="must belong to this user alone"):
            embedded_queue_server(folder)
    finally:
        short.rmdir()


def test_the_server_keeps_its_queue_over_a_kill_and_listens_on_no_network(tmp_path: Path) -> None:
    server = embedded_queue_server(tmp_path / "data with spaces")
    for number in range(2):
        with subprocess.Popen(server.command) as process:
            wait_until(server.is_answering)
            with queue_server.connect(server.url, timeout_s=10) as connection:
                assert connection.llen("list") == number
                connection.rpush("list", "entry")
                settings = connection.config_get()
            process.kill()
    assert (settings["port"], settings["maxmemory-policy"], settings["appendonly"]) == ("0", "noeviction", "yes")
    assert not server.is_answering()
    server.remove_socket()


def test_an_orphaned_server_is_stopped_first(tmp_path: Path) -> None:
    server = embedded_queue_server(tmp_path)
    stop_orphan(server)
    with subprocess.Popen(server.command) as process:
        wait_until(server.is_answering)
        stop_orphan(server)
        assert process.wait(30) == 0
    server.remove_socket()
