"""Hostile files: memory stays bounded, every error is reported, and nothing outside of the data folder is touched."""

import os
import socket
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from helpers.files.hostile import hostile_files
from helpers.files.hostile_sets import Files, hostile_sets
from helpers.files.samples import OBJ
from helpers.installation import LoggingInstallation
from helpers.jobs import sphere
from helpers.waiting import wait_until

ROOT = Path(__file__).parents[2]
MEMORY_BYTES = 2 * 2**30
GROWTH_BYTES = 64 * 2**20
# Paths outside of the data folder and the installation that may be read: devices and information of the kernel.
HARMLESS = ("/dev/", "/proc/self/", "/proc/vmstat", "/proc/stat", "/proc/cpuinfo", "/sys/")
LISTENING = {"socket.getaddrinfo\t127.0.0.1", "socket.bind\t('127.0.0.1', 0)"}


class AuditedInstallation(LoggingInstallation):
    """An installation whose processes log the files that they open and the addresses that they connect to."""

    def __init__(self, notes: Path) -> None:
        super().__init__()
        self.settings = LoggingInstallation.settings | {
            "AUDIT_LOG": str(notes),
            "PYTHONPATH": str(Path(__file__).parent / "audit"),
            "CLEAVE_JOB_MEMORY_BYTES": str(MEMORY_BYTES),
            "CLEAVE_MAX_UPLOAD_BYTES": str(4 * 2**20),
        }


@pytest.fixture
def target() -> Iterator[socket.socket]:
    """A listening socket to which no connection may be made."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        listening.settimeout(0.1)
        yield listening


def test_hostile_files_affect_only_their_jobs(tmp_path: Path, target: socket.socket) -> None:
    secret, notes = tmp_path / "secret", tmp_path / "notes"
    secret.write_text("not to be read")
    with AuditedInstallation(notes) as installation:
        submit(installation, [("warm.off", sphere(12))])
        wait_until(lambda: ended(installation))
        (service,) = installation.children("service.host.http_server")
        before = memory_bytes(service, "VmRSS")
        where = f"http://127.0.0.1:{target.getsockname()[1]}", str(secret)
        sets = [([(name, content)], codes) for name, content, codes in hostile_files(*where)]
        expected = {
            submit(installation, files): ([(name, content[:80]) for name, content in files], codes)
            for files, codes in [*sets, *hostile_sets(*where)]
        }
        check_invalid_requests(installation)
        wait_until(lambda: ended(installation), within_s=120)
        found = {path: code_of(installation, path) for path in expected}
        assert not [(files, found[path]) for path, (files, codes) in expected.items() if found[path] not in codes]
        assert installation.children("service.host.http_server") == [service]
        assert memory_bytes(service, "VmHWM") - before < GROWTH_BYTES
        assert max(work_horse_bytes(installation)) < MEMORY_BYTES
        assert code_of(installation, submit(installation, [("fine.off", sphere(12))]), wait=True) is None
        assert unexpected_events(notes, installation.data_dir) == LISTENING
        logged = notes.read_text(errors="replace")
        assert f"socket.connect\t{installation.data_dir}/queue/queue.sock" in logged  # the log works
        assert all(f"{path.rpartition('/')[2]}/mesh" in logged for path in expected)
    with pytest.raises(TimeoutError):
        target.accept()
    assert not list(Path("/tmp").glob("PWNED*"))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["notes", "secret"]


def submit(installation: LoggingInstallation, files: Files) -> str:
    """Submit the files of a model under names that are sent unchanged, and return the path of its job."""
    answer = httpx.post(
        f"{installation.url}/v1/jobs",
        files=[("mesh", file) for file in files],
        data={"parameters": '{"max_segments": 4}'},
        headers={"Cache-Control": "no-cache"},
        timeout=60,
    )
    assert answer.status_code in (200, 202), (files[0], answer.text)  # 200: the job has ended already
    assert "PWNED" not in answer.headers["Location"]
    return str(answer.headers["Location"])


def check_invalid_requests(installation: LoggingInstallation) -> None:
    """Check that invalid requests are refused without a job."""
    jobs = f"{installation.url}/v1/jobs"
    too_large = httpx.post(jobs, content=bytes(2**23), headers={"Content-Type": "model/stl"}, timeout=60)
    assert too_large.status_code == 413
    for name in ("../t.mtl", "/tmp/PWNED", "x/../../t.mtl", "C:/t.mtl"):
        outside = httpx.post(jobs, files=[("mesh", ("a.obj", OBJ)), ("mesh", (name, b"x"))], timeout=60)
        assert outside.status_code == 422, outside.text
    for parameters in ("[" * 50_000, '{"seed": 1e999, "\\ud800": NaN}'):
        refused = httpx.post(jobs, files={"mesh": b"x"}, data={"parameters": parameters}, timeout=60)
        assert 400 <= refused.status_code < 500, refused.text


def ended(installation: LoggingInstallation) -> bool:
    jobs = installation.get("/v1/jobs?limit=200").json()["jobs"]
    return all(job["finished_at"] for job in jobs)


def code_of(installation: LoggingInstallation, path: str, *, wait: bool = False) -> str | None:
    """Return the error code of a job; None if it has not failed."""
    if wait:
        wait_until(lambda: installation.get(path).json()["finished_at"])
    job = installation.get(path).json()
    return str(job["error"]["code"]) if job["status"] == "failed" else None


def memory_bytes(pid: int, name: str) -> int:
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(name))


def work_horse_bytes(installation: LoggingInstallation) -> list[int]:
    """Return the largest memory of each work-horse, from the log."""
    endings = [line["message"] for line in installation.lines() if "the work-horse ended with" in line["message"]]
    return [1024 * int(message.rpartition(", ")[2].removesuffix(" KiB")) for message in endings]


def unexpected_events(notes: Path, data_dir: Path) -> set[str]:
    """Return the events outside of the data folder and the installation that are not harmless."""
    own = (str(data_dir), str(ROOT), sys.prefix, sys.base_prefix, sys.exec_prefix)
    found = set()
    for line in notes.read_text(errors="replace").splitlines():
        event, _, what = line.partition("\t")
        is_number = what.isdigit()  # an open file descriptor, whose file was logged by its name
        place = what if event.startswith("socket") else os.path.normpath(ROOT / what)
        if not (is_number or place.startswith((*own, *HARMLESS)) or is_own_command(event, what)):
            found.add(line)
    return found


def is_own_command(event: str, what: str) -> bool:
    """Whether a started process is Python or the queue server."""
    return event == "subprocess.Popen" and os.path.basename(what).startswith(("python", "valkey", "redis"))
