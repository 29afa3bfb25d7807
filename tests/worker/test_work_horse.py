"""The end of a work-horse: what it says, and what is read from it."""

import os
import signal

import pytest

from worker.work_horse import EXIT_OUT_OF_MEMORY, cause_of_death, exit_status, out_of_memory_kills


def fail(error: BaseException) -> None:
    raise error


def test_the_exit_status_tells_success_want_of_memory_and_errors_apart() -> None:
    assert exit_status(lambda: None) == os.EX_OK
    assert exit_status(lambda: fail(MemoryError())) == EXIT_OUT_OF_MEMORY
    assert exit_status(lambda: fail(ZeroDivisionError())) == os.EX_SOFTWARE


@pytest.mark.parametrize(
    ("status", "cause"),
    [
        (EXIT_OUT_OF_MEMORY << 8, "out_of_memory"),
        (os.EX_SOFTWARE << 8, "internal_error"),
        (os.EX_OK << 8, "internal_error"),
        (signal.SIGKILL, "worker_lost"),
        (signal.SIGSEGV, "worker_lost"),
    ],
)
def test_the_cause_of_death_is_read_from_the_wait_status(status: int, cause: str) -> None:
    assert cause_of_death(int(status), kills_before=out_of_memory_kills()) == cause


def test_a_kill_while_the_kernel_killed_for_memory_is_put_down_to_memory() -> None:
    assert cause_of_death(signal.SIGKILL, kills_before=out_of_memory_kills() - 1) == "out_of_memory"
    assert cause_of_death(signal.SIGSEGV, kills_before=out_of_memory_kills() - 1) == "worker_lost"
