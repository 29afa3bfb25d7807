"""The embedded queue server comes back, whatever a loss of power has done to its files."""

import random
import shutil
import subprocess
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from helpers.waiting import wait_until
from service.host.programs import queue_server_program
from service.host.queue_files import set_aside_unreadable
from service.host.queue_server import QueueServer, embedded_queue_server
from service.host.supervisor import Supervisor
from worker.jobs.queue.connection import connect

Damage = Callable[[Path, random.Random], None]


def cut(file: Path, chance: random.Random) -> None:
    """The last writes never reached the disk."""
    file.write_bytes(file.read_bytes()[: chance.randrange(file.stat().st_size)])


def zero(file: Path, chance: random.Random) -> None:
    """The size reached the disk, and the last blocks did not."""
    data = file.read_bytes()
    begin = chance.randrange(len(data))
    file.write_bytes(data[:begin].ljust(len(data), b"\0"))


def scramble(file: Path, chance: random.Random) -> None:
    """A block in the middle has other bytes."""
    data = bytearray(file.read_bytes())
    begin = chance.randrange(len(data))
    end = min(begin + 512, len(data))
    data[begin:end] = chance.randbytes(end - begin)
    file.write_bytes(data)


def remove(file: Path, _: random.Random) -> None:
    file.unlink()


@pytest.fixture(scope="module")
def kept_files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files of a server that was killed with a queue of 626 jobs and some hashes."""
    server = embedded_queue_server(tmp_path_factory.mktemp("queue"))
    with subprocess.Popen(server.command) as process:
        wait_until(server.is_answering)
        with connect(server.url, timeout_s=10) as connection:
            for number in range(626):
                connection.hset(f"rq:job:{number}", mapping={"status": "queued", "data": bytes(range(256))})
                connection.rpush("rq:queue:small", number)
            connection.execute_command("BGREWRITEAOF")
            wait_until(lambda: connection.info("persistence")["aof_rewrite_in_progress"] == 0)
            for number in range(100):
                connection.rpush("rq:queue:large", number)
        process.kill()
    server.remove_socket()
    return server.folder / "appendonlydir"


@pytest.fixture
def server(tmp_path: Path, kept_files: Path) -> QueueServer:
    server = embedded_queue_server(tmp_path)
    shutil.copytree(kept_files, server.folder / "appendonlydir")
    return server


@pytest.mark.timeout(600)
def test_a_server_whose_files_were_torn_at_random_places_always_answers_again(
    tmp_path: Path, kept_files: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.host.supervisor._FIRST_DELAY_S", 0.02)
    set_aside = 0
    for seed in range(50):
        chance = random.Random(seed)
        server = embedded_queue_server(tmp_path / str(seed))
        shutil.copytree(kept_files, server.folder / "appendonlydir")
        damage: Damage = chance.choice([cut, zero, scramble, remove])
        damage(chance.choice(sorted((server.folder / "appendonlydir").iterdir())), chance)
        assert_comes_back(server)
        set_aside += (server.folder / "damaged").exists()
    assert 5 <= set_aside < 50  # the server itself repairs some of them


def assert_comes_back(server: QueueServer) -> None:
    """Run the server as `cleave serve` does until it answers and takes an entry."""
    supervisor = Supervisor([queue_server_program(server)])
    running = threading.Event()

    def keep_running() -> None:
        (child,) = supervisor._children
        while not running.wait(0.01):
            child.keep_running()
        child.kill()

    thread = threading.Thread(target=keep_running)
    thread.start()
    try:
        wait_until(server.is_answering)
        with connect(server.url, timeout_s=10) as connection:
            assert connection.rpush("probe", "entry") == 1
    finally:
        running.set()
        thread.join()
        server.remove_socket()


def test_files_of_a_server_that_was_ready_are_never_set_aside(server: QueueServer) -> None:
    with subprocess.Popen(server.command) as process:
        wait_until(server.is_answering)
        process.kill()
        status = process.wait()
    set_aside_unreadable(server.folder, status)
    assert (server.folder / "appendonlydir").exists()
    server.remove_socket()


def test_files_that_were_set_aside_earlier_make_room_for_newer_ones(server: QueueServer) -> None:
    (server.folder / "damaged").mkdir()
    (server.folder / "damaged" / "old").touch()
    set_aside_unreadable(server.folder, 1)
    assert not (server.folder / "appendonlydir").exists()
    assert not (server.folder / "damaged" / "old").exists()
    assert any((server.folder / "damaged").iterdir())


def test_a_server_that_was_stopped_keeps_its_files(server: QueueServer) -> None:
    set_aside_unreadable(server.folder, 0)
    assert (server.folder / "appendonlydir").exists()
