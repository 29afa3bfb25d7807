"""Outages of the queue server: workers finish the running job, and continue when the server is back."""

import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from helpers.jobs import LONG, SMALL, accepted, sphere
from helpers.processes import StartWorker, horses_of
from helpers.waiting import wait_until
from service.host.queue_server import QueueServer, embedded_queue_server
from worker.jobs.job import Job, Succeeded
from worker.jobs.queue.connection import QueueError, connect
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore


class Server:
    """A queue server that a test can kill and replace by an empty one."""

    def __init__(self, server: QueueServer) -> None:
        self.url = server.url
        self._server = server
        self.start()

    def start(self) -> None:
        self.process = subprocess.Popen(self._server.command)
        wait_until(self._server.is_answering)

    def lose(self) -> None:
        """Kill the server and remove its files."""
        self.process.kill()
        self.process.wait()
        for path in self._server.socket.parent.rglob("*.aof*"):
            path.unlink()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    server = Server(embedded_queue_server(tmp_path))
    yield server
    server.process.kill()
    server.process.wait()


def succeeded(store: JobStore, job_id: str) -> bool:
    return isinstance(store.records.outcome(job_id), Succeeded)


def at_work(
    start_worker: StartWorker, store: JobStore, server: Server
) -> tuple[JobQueue, subprocess.Popen[bytes], Job]:
    """Start a worker; return the queue, the worker, and a long job that it runs."""
    queue = JobQueue(connect(server.url))
    worker = start_worker(CLEAVE_REDIS_URL=server.url)
    running = accepted(store, sphere(100), **LONG)
    queue.enqueue(running.id, SMALL)
    wait_until(lambda: horses_of(worker.pid))
    return queue, worker, running


def test_a_worker_survives_the_loss_of_its_queue_server(
    start_worker: StartWorker, store: JobStore, server: Server
) -> None:
    queue, worker, running = at_work(start_worker, store, server)
    server.lose()
    wait_until(lambda: succeeded(store, running.id))  # without a queue server
    wait_until(lambda: not horses_of(worker.pid))
    with pytest.raises(QueueError):
        queue.lengths()
    server.start()
    following = accepted(store, sphere(12))
    queue.enqueue(following.id, SMALL)
    wait_until(lambda: succeeded(store, following.id))
    assert worker.poll() is None
    assert len(store.records.attempts(running.id)) == 1
    assert queue.lengths()[SMALL] == 0


def test_a_queue_server_that_hangs_does_not_stop_a_job(
    start_worker: StartWorker, store: JobStore, server: Server
) -> None:
    queue, worker, running = at_work(start_worker, store, server)
    server.process.send_signal(signal.SIGSTOP)
    try:
        wait_until(lambda: succeeded(store, running.id))
    finally:
        server.process.send_signal(signal.SIGCONT)
    following = accepted(store, sphere(12))
    queue.enqueue(following.id, SMALL)
    wait_until(lambda: succeeded(store, following.id))
    assert worker.poll() is None
