"""The faults of a soak: processes are killed, as by the kernel, an operator or a power cut."""

import os
import random
import shutil
import signal
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress

from bench.load.installation import Installation

_FOUND_WITHIN_S = 5.0  # longest wait for a process to kill; set by hand

# The relative frequency of each fault, out of 20; set by hand, most of them for the processes that hold jobs.
_WEIGHTS = {"work-horse": 6, "worker": 5, "worker and work-horse": 5, "janitor": 2, "service": 2}
WORKER_DEATHS = ("worker", "worker and work-horse")
QUEUE_SERVER = "queue server"
EMPTIED_QUEUE_SERVER = "queue server and its files"


def schedule(kills: int, queue_kills: int, rng: random.Random) -> list[str]:
    """Return the faults in their order; the last but one of the queue server also deletes its files."""
    names = list(_WEIGHTS)
    faults = [*names, *rng.choices(names, list(_WEIGHTS.values()), k=max(0, kills - len(names)))][:kills]
    rng.shuffle(faults)
    servers = [QUEUE_SERVER] * queue_kills
    if queue_kills:
        servers[max(0, queue_kills - 2)] = EMPTIED_QUEUE_SERVER
    for number, fault in enumerate(servers, 1):
        faults.insert(number * len(faults) // (queue_kills + 1), fault)
    return faults


def inflict(fault: str, installation: Installation, rng: random.Random) -> bool:
    """Inflict a fault; return False if no such process appeared for some seconds."""
    return _FAULTS[fault](installation, rng)


def describe(counts: Counter[str]) -> str:
    """Return the number of faults of each kind as text."""
    return ", ".join(f"{count} {name}" for name, count in sorted(counts.items()))


def _kill_work_horse(installation: Installation, rng: random.Random) -> bool:
    return _kill(_some(installation.work_horses, rng))


def _kill_worker(installation: Installation, rng: random.Random) -> bool:
    return _kill(_some(lambda: installation.children("worker.process"), rng))


def _kill_both(installation: Installation, rng: random.Random) -> bool:
    """Kill a worker during a job together with its work-horse."""
    horses = _some(installation.work_horses, rng)
    return _kill([_parent_of(horses[0]), *horses]) if horses else False


def _kill_child(word: str) -> Callable[[Installation, random.Random], bool]:
    return lambda installation, rng: _kill(_some(lambda: installation.children(word), rng))


def _empty_queue_server(installation: Installation, rng: random.Random) -> bool:
    """Kill the queue server and delete its files, so that it restarts empty."""
    servers = _some(lambda: installation.children("queue.sock"), rng)
    for server in servers:
        with suppress(ProcessLookupError):
            os.kill(server, signal.SIGSTOP)  # so that it is not restarted before its files are deleted
    for path in (installation.data_dir / "queue").glob("append*"):
        shutil.rmtree(path, ignore_errors=True)
    return _kill(servers)


_FAULTS: dict[str, Callable[[Installation, random.Random], bool]] = {
    "work-horse": _kill_work_horse,
    "worker": _kill_worker,
    "worker and work-horse": _kill_both,
    "janitor": _kill_child("worker.janitor"),
    "service": _kill_child("service.host.http_server"),
    QUEUE_SERVER: _kill_child("queue.sock"),
    EMPTIED_QUEUE_SERVER: _empty_queue_server,
}


def _some(find: Callable[[], list[int]], rng: random.Random) -> list[int]:
    """Wait for processes and return one of them; an empty list if there is none in time."""
    deadline = time.monotonic() + _FOUND_WITHIN_S
    while time.monotonic() < deadline:
        found = [pid for pid in find() if pid]
        if found:
            return [rng.choice(found)]
        time.sleep(0.02)
    return []


def _kill(pids: list[int]) -> bool:
    killed = False
    for pid in pids:
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
            killed = True
    return killed


def _parent_of(pid: int) -> int:
    try:
        with open(f"/proc/{pid}/stat") as file:
            return int(file.read().rpartition(")")[2].split()[1])
    except (FileNotFoundError, ProcessLookupError):
        return pid
