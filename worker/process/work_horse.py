"""What a work-horse may use, and what its end says to the process that waits for it."""

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

EXIT_OUT_OF_MEMORY = 71
EXIT_FILE_TOO_LARGE = 73
EXIT_CANNOT_STORE = os.EX_TEMPFAIL
_CPU_MARGIN_S = 5

# How a run ends without an outcome: what becomes an attempt with a cause, and what is not counted.
Ending: TypeAlias = Cause | Literal["ended elsewhere", "shutdown", "cannot store"]
_ENDINGS: dict[int, Ending] = {
    EXIT_OUT_OF_MEMORY: "out_of_memory",
    EXIT_FILE_TOO_LARGE: "file_too_large",
    EXIT_CANNOT_STORE: "cannot store",
}


def exit_status(work: Callable[[], None]) -> int:
    """Run the work of a work-horse; what its parent can tell from the exit status."""
    try:
        work()
    except MemoryError:
        log.error("the job needs more memory than it may have")
        return EXIT_OUT_OF_MEMORY
    except OSError as error:
        if is_disk_full(error):
            log.error("the disk is full")
            return EXIT_CANNOT_STORE
        if error.errno == errno.EFBIG:
            log.error("the job writes a larger file than it may")
            return EXIT_FILE_TOO_LARGE
        log.exception("the job stopped at an error of the system")
        return os.EX_SOFTWARE
    except Exception:
        log.exception("the job stopped at an error that it does not expect")
        return os.EX_SOFTWARE
    return os.EX_OK


def ending_of(status: int, kills_before: int) -> Ending:
    """Why a work-horse ended without an outcome, from its wait status and the kernel's count of kills for memory."""
    if os.WIFEXITED(status):
        return _ENDINGS.get(os.WEXITSTATUS(status), "internal_error")
    match os.WTERMSIG(status):
        case signal.SIGXCPU:
            return "timed_out"
        case signal.SIGKILL if out_of_memory_kills() > kills_before:
            return "out_of_memory"
    return "worker_lost"


def out_of_memory_kills() -> int:
    """How many processes of this machine the kernel has killed for want of memory; 0 where it does not say."""
    try:
        lines = Path("/proc/vmstat").read_text().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) for line in lines if line.startswith("oom_kill "))


def limit_resources(settings: Settings) -> None:
    """Bound what this process may use, for good: what a hostile mesh does, it does to its own job alone."""
    _limit(resource.RLIMIT_AS, settings.job_memory_bytes)
    _limit(resource.RLIMIT_FSIZE, settings.job_file_bytes)
    _limit(resource.RLIMIT_CORE, 0)  # meshes do not end up in files that nobody knows of
    # At the lower limit comes SIGXCPU, which says why; at the higher one SIGKILL.
    _limit(resource.RLIMIT_CPU, settings.job_cpu_s, settings.job_cpu_s + _CPU_MARGIN_S)


def _limit(kind: int, soft: int, hard: int | None = None) -> None:
    """Lower a limit, as far as it is not lower already."""
    _, allowed = resource.getrlimit(kind)
    most = soft if hard is None else hard
    if allowed == resource.RLIM_INFINITY or most <= allowed:
        resource.setrlimit(kind, (soft, most))
    else:
        resource.setrlimit(kind, (min(soft, allowed), allowed))
