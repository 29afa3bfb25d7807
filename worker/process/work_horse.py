"""The work-horse: its resource limits, its exit status, and what its parent reads from that."""

import errno
import logging
import os
import resource
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Literal, TypeAlias

from cleave.settings import Settings
from worker.jobs.attempts import Cause
from worker.jobs.objects.durable import is_disk_full

log = logging.getLogger("cleave.work_horse")

# The statuses of sysexits.h that come closest: system error, cannot create output, temporary failure.
EXIT_OUT_OF_MEMORY = os.EX_OSERR
EXIT_FILE_TOO_LARGE = os.EX_CANTCREAT
EXIT_CANNOT_STORE = os.EX_TEMPFAIL
_CPU_MARGIN_S = 5  # from SIGXCPU to SIGKILL; set by hand

# How a run ends without an outcome: a cause is recorded in the attempt, the others are not counted as attempts.
Ending: TypeAlias = Cause | Literal["ended elsewhere", "shutdown", "cannot store"]
_ENDINGS: dict[int, Ending] = {
    EXIT_OUT_OF_MEMORY: "out_of_memory",
    EXIT_FILE_TOO_LARGE: "file_too_large",
    EXIT_CANNOT_STORE: "cannot store",
}


def exit_status(work: Callable[[], None]) -> int:
    """Run the job in a work-horse; return the exit status, from which its parent reads why it ended."""
    try:
        work()
    except MemoryError:
        log.error("the job needs more memory than the limit")
        return EXIT_OUT_OF_MEMORY
    except OSError as error:
        if is_disk_full(error):
            log.error("the disk is full")
            return EXIT_CANNOT_STORE
        if error.errno == errno.EFBIG:
            log.error("the job writes a larger file than the limit")
            return EXIT_FILE_TOO_LARGE
        log.exception("the job stopped at a system error")
        return os.EX_SOFTWARE
    except Exception:
        log.exception("the job stopped at an unexpected error")
        return os.EX_SOFTWARE
    return os.EX_OK


def ending_of(status: int, kills_before: int) -> Ending:
    """Return why a work-horse ended without an outcome, from its wait status and the kernel's out-of-memory kills."""
    if os.WIFEXITED(status):
        return _ENDINGS.get(os.WEXITSTATUS(status), "internal_error")
    match os.WTERMSIG(status):
        case signal.SIGXCPU:
            return "timed_out"
        case signal.SIGKILL if out_of_memory_kills() > kills_before:
            return "out_of_memory"
    return "worker_lost"


def out_of_memory_kills() -> int:
    """Return how many processes the kernel has killed for lack of memory; 0 if it does not report that."""
    try:
        lines = Path("/proc/vmstat").read_text().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) for line in lines if line.startswith("oom_kill "))


def limit_resources(settings: Settings) -> None:
    """Limit the resources of this process irrevocably, so that a hostile mesh affects its own job alone."""
    _limit(resource.RLIMIT_AS, settings.job_memory_bytes)
    _limit(resource.RLIMIT_FSIZE, settings.job_file_bytes)
    _limit(resource.RLIMIT_CORE, 0)  # no core files with the contents of meshes
    # SIGXCPU at the lower limit tells the parent why the process ended; at the higher one the kernel sends SIGKILL.
    _limit(resource.RLIMIT_CPU, settings.job_cpu_s, settings.job_cpu_s + _CPU_MARGIN_S)


def _limit(kind: int, soft: int, hard: int | None = None) -> None:
    """Lower a limit, unless it is lower already."""
    _, allowed = resource.getrlimit(kind)
    most = soft if hard is None else hard
    if allowed == resource.RLIM_INFINITY or most <= allowed:
        resource.setrlimit(kind, (soft, most))
    else:
        resource.setrlimit(kind, (min(soft, allowed), allowed))
