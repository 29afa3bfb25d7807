"""What is done to an installation: its processes are killed, as the kernel, an operator or a power cut would do it."""

import os
import random
import shutil
import signal
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress

from bench.load.installation import Installation

_PATIENCE_S = 5.0  # until there is a process to kill

# How often each fault is, out of 20.
_WEIGHTS = {"work-horse": 6, "worker": 5, "worker and work-horse": 5, "janitor": 2, "service": 2}
WORKER_DEATHS = ("worker", "worker and work-horse")
QUEUE_SERVER = "queue server"
EMPTIED_QUEUE_SERVER = "queue server and its files"


def schedule(kills: int, queue_kills: int, rng: random.Random) -> list[str]:
    """The faults in the order in which they come; the last but one of the queue server costs its files."""
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
    """Do one of them; False where there was nothing to kill for seconds."""
    return _DEEDS[fault](installation, rng)


def tell(counts: Counter[str]) -> str:
    return ", ".join(f"{count} {name}" for name, count in sorted(counts.items()))


def _kill_work_horse(installation: Installation, rng: random.Random) -> bool:
    return _kill(_some(installation.work_horses, rng))


def _kill_worker(installation: Installation, rng: random.Random) -> bool:
    return _kill(_some(lambda: installation.children("worker.process"), rng))


def _kill_both(installation: Installation, rng: random.Random) -> bool:
    """A worker in the middle of a job, and its work-horse with it."""
    horses = _some(installation.work_horses, rng)
    return _kill([_parent_of(horses[0]), *horses]) if horses else False


def _kill_child(word: str) -> Callable[[Installation, random.Random], bool]:
    return lambda installation, rng: _kill(_some(lambda: installation.children(word), rng))


def _empty_queue_server(installation: Installation, rng: random.Random) -> bool:
    """It comes back as another, empty one."""
    servers = _some(lambda: installation.children("queue.sock"), rng)
    for server in servers:
        with suppress(ProcessLookupError):
            os.kill(server, signal.SIGSTOP)  # so that it is not started again before its files are gone
    for path in (installation.data_dir / "queue").glob("append*"):
        shutil.rmtree(path, ignore_errors=True)
    return _kill(servers)


_DEEDS: dict[str, Callable[[Installation, random.Random], bool]] = {
    "work-horse": _kill_work_horse,
    "worker": _kill_worker,
    "worker and work-horse": _kill_both,
    "janitor": _kill_child("worker.janitor"),
    "service": _kill_child("service.host.http_server"),
    QUEUE_SERVER: _kill_child("queue.sock"),
    EMPTIED_QUEUE_SERVER: _empty_queue_server,
}


def _some(find: Callable[[], list[int]], rng: random.Random) -> list[int]:
    """One of the processes, once there are any; none after a while without."""
    gives_up_at = time.monotonic() + _PATIENCE_S
    while time.monotonic() < gives_up_at:
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
