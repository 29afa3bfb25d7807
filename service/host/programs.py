"""The processes of an installation: how many there are, and how each is started."""

import os
import sys
import sysconfig
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from cleave.settings import Settings
from service.host.queue_files import set_aside_unreadable
from service.host.queue_server import QueueServer
from service.host.start_signal import StartSignal
from service.host.supervisor import Program
from worker.jobs.size_class import SizeClass

_STOP_MARGIN_S = 4.0  # for a worker to update the queue after its job has ended or was handed back; set by hand

# A work-horse runs one job on one core: threads of numerical libraries would only compete with the other work-horses.
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
# The threads of Cleave itself (CLEAVE_JOB_THREADS) share one heap of glibc. Two heaps would keep 0.1 kB for each face
# that was freed.
_ONE_HEAP = {"MALLOC_ARENA_MAX": "1"}


def queue_server_program(server: QueueServer) -> Program:
    """Return the program of the queue server, which is started again with an empty queue if its files are damaged."""
    on_end = partial(set_aside_unreadable, server.folder)
    return Program("queue server", server.command, is_support=True, on_end=on_end)


def api_program(settings: Settings, listening: int, started: StartSignal) -> Program:
    """Return the program of the HTTP server on a socket, which is given by its file descriptor."""
    command = _python("service.host.http_server", str(listening), str(started.descriptor))
    return Program("service", command, _environment(settings), descriptors=(listening, started.descriptor))


def worker_programs(
    settings: Settings, counts: Mapping[SizeClass, int], starts_after: Callable[[], bool] | None = None
) -> list[Program]:
    """Return the workers of each queue, the janitor, which recovers lost jobs, and the sender of webhooks."""
    environment = _environment(settings)
    threads = {name: os.environ.get(name, value) for name, value in (_ONE_THREAD | _ONE_HEAP).items()}
    grace_s = settings.shutdown_grace_s + _STOP_MARGIN_S
    workers = [
        Program(
            f"worker {number} for {size} jobs",
            _python("worker.process", size),
            environment | threads,
            grace_s=grace_s,
            starts_after=starts_after,
        )
        for size, count in counts.items()
        for number in range(1, count + 1)
    ]
    others = {"janitor": "worker.janitor", "webhook sender": "worker.webhooks"}
    return [
        *workers,
        *(Program(name, _python(module), environment, starts_after=starts_after) for name, module in others.items()),
    ]


def worker_counts(total: int | None, only: SizeClass | None = None) -> dict[SizeClass, int]:
    """Return the number of workers of each queue.

    A quarter of them run large jobs; the share is set by hand. Every queue has at least one worker, so there may be one
    more than ``total``.

    Parameters
    ----------
    total : workers; by default one less than cores, which leaves a core to the HTTP server.
    only : the only queue that gets workers.
    """
    if total is None:
        total = max(1, _cores() - 1)
    if only is not None or total == 0:
        return {size: total for size in SizeClass if size == only}
    large = max(1, total // 4)
    return {SizeClass.SMALL: max(1, total - large), SizeClass.LARGE: large}


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _python(module: str, *arguments: str) -> list[str]:
    return [sys.executable, "-P", "-m", module, *arguments]


def _environment(settings: Settings) -> dict[str, str]:
    """Return the variables for a program: the resolved settings, and the path of the packages."""
    assert settings.redis_url, "the queue server is known by now"
    environment = {"CLEAVE_DATA_DIR": str(settings.data_dir), "CLEAVE_REDIS_URL": settings.redis_url}
    environment["CLEAVE_ROOT_PATH"] = settings.root_path
    root = Path(__file__).parents[2]
    if root != Path(sysconfig.get_path("purelib")):  # a checkout: -P keeps the working folder off the path
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, [str(root), os.environ.get("PYTHONPATH")]))
    return environment
