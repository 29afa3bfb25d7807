"""No accepted job is lost if a process dies, and no process or file remains after a stop."""

import json
import os
import signal
import socket
from datetime import datetime
from pathlib import Path

import pytest

from helpers.installation import Installation
from helpers.jobs import LONG, sphere
from helpers.processes import horses_of
from helpers.waiting import wait_until
from worker.jobs.job import now


def test_a_job_whose_worker_and_work_horse_are_killed_together_runs_again_within_thirty_seconds() -> None:
    with Installation() as installation:
        path = installation.submit(sphere(100), json.dumps(LONG))
        wait_until(installation.horses)
        (horse,) = installation.horses()
        (worker,) = [pid for pid in installation.children("worker.process") if horse in horses_of(pid)]
        killed_at = now()
        os.kill(worker, signal.SIGKILL)
        os.kill(horse, signal.SIGKILL)
        wait_until(lambda: installation.get(path).json()["attempts"] == 2)
        began_at = datetime.fromisoformat(installation.get(path).json()["started_at"])
        assert (began_at - killed_at).total_seconds() < 30
        wait_until(lambda: installation.status(path) == "succeeded")


@pytest.mark.parametrize(("number", "waiting"), [(signal.SIGINT, 6), (signal.SIGKILL, 20)])
def test_a_restart_finishes_the_running_and_the_waiting_jobs(number: signal.Signals, waiting: int) -> None:
    with Installation() as installation:
        paths = []
        for running, rows in enumerate((80, 100), 1):  # a small one, a large one
            paths.append(installation.submit(sphere(rows), json.dumps(LONG)))
            wait_until(lambda running=running: len(installation.horses()) == running)
            for horse in installation.horses():
                os.kill(horse, signal.SIGSTOP)  # so that the jobs do not end
        paths += [installation.submit(sphere(12)) for _ in range(waiting)]
        assert installation.stop(number) == (-signal.SIGKILL if number == signal.SIGKILL else 0)
        wait_until(lambda: not installation.processes(), within_s=10)
        installation.start()
        wait_until(lambda: installation.statuses(paths) == {"succeeded"}, within_s=200)


def test_a_signal_to_all_processes_fails_no_job() -> None:
    with Installation() as installation:
        path = installation.submit(sphere(100), json.dumps(LONG))
        wait_until(installation.horses)
        for pid in installation.processes():
            os.kill(pid, signal.SIGTERM)
        assert installation.wait() == 0
        wait_until(lambda: not installation.processes(), within_s=10)
        installation.start()
        wait_until(lambda: installation.status(path) == "succeeded", within_s=120)


def test_a_port_in_use_is_an_error_before_anything_starts() -> None:
    installation = Installation()
    with socket.create_server(("127.0.0.1", 0)) as other:
        process = installation.command("serve", "--port", str(other.getsockname()[1]))
        output, _ = process.communicate(timeout=60)
        assert (process.returncode, output) == (2, "")
    assert list(installation.data_dir.iterdir()) == []
    installation.data_dir.rmdir()


def test_separate_workers_run_the_jobs_of_a_service() -> None:
    with Installation(workers=1) as installation:
        url = f"unix://{installation.data_dir}/queue/queue.sock"
        for worker in installation.children("worker.process"):
            os.kill(worker, signal.SIGSTOP)
        workers = installation.command("worker", "--redis-url", url, "--workers", "1")
        try:
            path = installation.submit(sphere(20))
            wait_until(lambda: installation.status(path) == "succeeded")
        finally:
            workers.terminate()
            assert workers.wait(60) == 0
            assert workers.stdout is not None
            workers.stdout.close()


@pytest.mark.parametrize("folder", ["long" * 20, "Application Support, a=b, 50% & 'c'#1?"])
def test_a_data_folder_with_an_odd_path_has_a_plain_socket_path(tmp_path: Path, folder: str) -> None:
    installation = Installation(workers=1)
    installation.data_dir.rmdir()
    installation.data_dir = tmp_path / folder
    with installation:
        path = installation.submit(sphere(12))
        wait_until(lambda: installation.status(path) == "succeeded")
        installation.stop()
        assert not (installation.data_dir / "queue" / "queue.sock").exists()


def test_a_damaged_queue_costs_no_job() -> None:
    """After a loss of power the files of the queue server may be torn; the store has every job."""
    with Installation(workers=1) as installation:
        paths = [installation.submit(sphere(12)) for _ in range(20)]
        installation.kill()
        wait_until(lambda: not installation.processes())
        for file in (installation.data_dir / "queue" / "appendonlydir").glob("*.[ar][od][fb]"):  # changes and base
            data = file.read_bytes()
            file.write_bytes(data[: len(data) // 2] + b"*" * 1000 + data[len(data) // 2 :])
        installation.start()
        wait_until(lambda: installation.statuses(paths) == {"succeeded"}, within_s=120)
        assert (installation.data_dir / "queue" / "damaged").is_dir()
