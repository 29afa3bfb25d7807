"""The supervisor restarts programs that end, stops all of them on a signal, and locks the data folder."""

import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from helpers.processes import children_of, is_alive
from helpers.waiting import wait_until
from service.host.supervisor import DataInUse, lock_data


def supervise(tmp_path: Path, *programs: str) -> "subprocess.Popen[bytes]":
    """Start a process that supervises Python programs, each given by its source."""
    sources = []
    for number, source in enumerate(programs):
        path = tmp_path / f"program{number}.py"
        path.write_text(textwrap.dedent(source))
        sources.append(str(path))
    script = textwrap.dedent(
        f"""
        import sys
        from service.host.supervisor import Program, Supervisor
        Supervisor(Program(path, [sys.executable, path], grace_s=1.0) for path in {sources!r}).run()
        """
    )
    return subprocess.Popen([sys.executable, "-c", script], stderr=subprocess.DEVNULL)


FOREVER = "import time\ntime.sleep(1000)"
STUBBORN = "import signal, time\nsignal.signal(signal.SIGTERM, signal.SIG_IGN)\ntime.sleep(1000)"


def test_a_program_that_ends_is_restarted_after_growing_delays(tmp_path: Path) -> None:
    starts = tmp_path / "starts"
    began_at = time.monotonic()
    with supervise(tmp_path, f"print('start', file=open({str(starts)!r}, 'a'))") as supervisor:
        wait_until(lambda: starts.exists() and starts.read_text().count("start") >= 3)
        assert time.monotonic() - began_at > 1 + 2
        supervisor.terminate()
        assert supervisor.wait(30) == 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_stops_all_programs_even_if_they_ignore_it(tmp_path: Path, number: signal.Signals) -> None:
    with supervise(tmp_path, FOREVER, STUBBORN) as supervisor:
        wait_until(lambda: len(children_of(supervisor.pid)) == 2)
        children = children_of(supervisor.pid)
        supervisor.send_signal(number)
        assert supervisor.wait(30) == 0
    assert not any(is_alive(child) for child in children)


def test_the_programs_of_a_killed_supervisor_are_killed(tmp_path: Path) -> None:
    with supervise(tmp_path, FOREVER, STUBBORN) as supervisor:
        wait_until(lambda: len(children_of(supervisor.pid)) == 2)
        children = children_of(supervisor.pid)
        supervisor.kill()
    wait_until(lambda: not any(is_alive(child) for child in children), within_s=10)


def test_a_data_folder_is_locked_by_one_process_at_a_time(tmp_path: Path) -> None:
    data_dir = tmp_path / "data"
    with lock_data(data_dir), pytest.raises(DataInUse, match=str(data_dir)):
        lock_data(data_dir)
    with lock_data(data_dir):
        pass


def test_a_program_waits_for_the_signal_of_another_one(tmp_path: Path) -> None:
    started = tmp_path / "started"
    script = f"""
        import sys
        from service.host.start_signal import StartSignal
        from service.host.supervisor import Program, Supervisor
        signal = StartSignal()
        first = f"import os, time; time.sleep(1); os.write({{signal.descriptor}}, b'1'); time.sleep(1000)"
        second = "import time; open({str(started)!r}, 'w').close(); time.sleep(1000)"
        Supervisor([
            Program("second", [sys.executable, "-c", second], starts_after=signal.has_come),
            Program("first", [sys.executable, "-c", first], descriptors=(signal.descriptor,)),
        ]).run()
    """
    with subprocess.Popen([sys.executable, "-c", textwrap.dedent(script)], stderr=subprocess.DEVNULL) as supervisor:
        wait_until(lambda: len(children_of(supervisor.pid)) == 1)
        assert not started.exists()
        wait_until(started.exists)
        assert len(children_of(supervisor.pid)) == 2
        supervisor.terminate()
        assert supervisor.wait(30) == 0
