"""The end of a work-horse: what it says, and what is read from it."""

import errno
import os
import signal
import subprocess
import sys

import pytest

from worker.process.work_horse import (
    EXIT_CANNOT_STORE,
    EXIT_FILE_TOO_LARGE,
    EXIT_OUT_OF_MEMORY,
    ending_of,
    exit_status,
    out_of_memory_kills,
)


def fail(error: BaseException) -> None:
    raise error


def test_the_exit_status_tells_success_want_of_memory_and_errors_apart() -> None:
    assert exit_status(lambda: None) == os.EX_OK
    assert exit_status(lambda: fail(MemoryError())) == EXIT_OUT_OF_MEMORY
    assert exit_status(lambda: fail(OSError(errno.EFBIG, "File too large"))) == EXIT_FILE_TOO_LARGE
    assert exit_status(lambda: fail(OSError(errno.ENOSPC, "No space left on device"))) == EXIT_CANNOT_STORE
    assert exit_status(lambda: fail(PermissionError())) == os.EX_SOFTWARE
    assert exit_status(lambda: fail(ZeroDivisionError())) == os.EX_SOFTWARE


@pytest.mark.parametrize(
    ("status", "cause"),
    [
        (EXIT_OUT_OF_MEMORY << 8, "out_of_memory"),
        (os.EX_SOFTWARE << 8, "internal_error"),
        (os.EX_OK << 8, "internal_error"),
        (signal.SIGKILL, "worker_lost"),
        (EXIT_FILE_TOO_LARGE << 8, "file_too_large"),
        (EXIT_CANNOT_STORE << 8, "cannot store"),
        (signal.SIGSEGV, "worker_lost"),
        (signal.SIGXCPU, "timed_out"),
    ],
)
def test_the_ending_is_read_from_the_wait_status(status: int, cause: str) -> None:
    assert ending_of(int(status), kills_before=out_of_memory_kills()) == cause


def test_a_kill_while_the_kernel_killed_for_memory_is_put_down_to_memory() -> None:
    assert ending_of(signal.SIGKILL, kills_before=out_of_memory_kills() - 1) == "out_of_memory"
    assert ending_of(signal.SIGSEGV, kills_before=out_of_memory_kills() - 1) == "worker_lost"


def test_a_work_horse_cannot_lift_its_limits_and_leaves_no_core() -> None:
    source = """
import resource
from cleave.settings import Settings
from worker.process.work_horse import limit_resources
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))  # an operator's own is never raised
limit_resources(Settings(job_memory_bytes=2**33, job_cpu_s=77, job_file_bytes=2000))
for name in ("AS", "CPU", "FSIZE", "CORE"):
    print(*resource.getrlimit(getattr(resource, "RLIMIT_" + name)))
"""
    done = subprocess.run([sys.executable, "-c", source], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [f"{2**33} {2**33}", "77 82", "1000 1000", "0 0"]
