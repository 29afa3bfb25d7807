"""What a work-horse may use, and what its end says to the process that waits for it."""

import logging
import os
import resource
import signal
from collections.abc import Callable
from pathlib import Path

from worker.durable import is_disk_full
from worker.jobs import Cause

log = logging.getLogger("cleave.work_horse")

EXIT_OUT_OF_MEMORY = 71
_EXIT_CANNOT_STORE = os.EX_TEMPFAIL


def exit_status(work: Callable[[], None]) -> int:
    """Run the work of a work-horse; what its parent can tell from the exit status."""
    try:
        work()
    except MemoryError:
        log.error("the job needs more memory than it may have")
        return EXIT_OUT_OF_MEMORY
    except OSError as error:
        if not is_disk_full(error):
            log.exception("the job stopped at an error of the system")
            return os.EX_SOFTWARE
        log.error("the disk is full")
        return _EXIT_CANNOT_STORE
    except Exception:
        log.exception("the job stopped at an error that it does not expect")
        return os.EX_SOFTWARE
    return os.EX_OK


def cannot_store(status: int) -> bool:
    """Whether a work-horse ended with this wait status because the disk is full."""
    return os.WIFEXITED(status) and os.WEXITSTATUS(status) == _EXIT_CANNOT_STORE


def cause_of_death(status: int, kills_before: int) -> Cause:
    """Why a work-horse ended without an outcome, from its wait status and the kernel's count of kills for memory."""
    if os.WIFEXITED(status):
        return "out_of_memory" if os.WEXITSTATUS(status) == EXIT_OUT_OF_MEMORY else "internal_error"
    killed = os.WTERMSIG(status) == signal.SIGKILL
    return "out_of_memory" if killed and out_of_memory_kills() > kills_before else "worker_lost"


def out_of_memory_kills() -> int:
    """How many processes of this machine the kernel has killed for want of memory; 0 where it does not say."""
    try:
        lines = Path("/proc/vmstat").read_text().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) for line in lines if line.startswith("oom_kill "))


def limit_memory(address_space_bytes: int | None) -> None:
    if address_space_bytes is not None:
        resource.setrlimit(resource.RLIMIT_AS, (address_space_bytes, address_space_bytes))
