"""Kernels are compiled once by whatever number of processes, and a process that is killed breaks nothing."""

import json
import subprocess
from contextlib import ExitStack
from pathlib import Path

import pytest

from helpers.processes import children_of, is_alive
from helpers.storage.kernels import cache_folder, copy_kernels, environment_with, python_command
from helpers.waiting import wait_until
from segcore.kernels import CompilationProgress
from segcore.kernels.manifest import kernels
from segcore.kernels.place import KernelPlace

GROUP = "draw"  # the smallest one
COUNT = sum(kernel.group == GROUP for kernel in kernels())
COMPILE = f"""
from segcore.kernels import compile_kernels, must_compile
assert must_compile(["{GROUP}"])
compile_kernels(["{GROUP}"], lambda progress: print(progress.done, progress.count, progress.is_own, flush=True))
assert not must_compile(["{GROUP}"])
"""
# The number of kernels that had to be compiled although they should be in the cache.
MISSES = f"""
from segcore.kernels.manifest import kernels
from segcore.kernels.signatures import named
chosen = [kernel for kernel in kernels() if kernel.group == "{GROUP}"]
for kernel in chosen:
    kernel.compile()
print(sum(sum(named(place).stats.cache_misses.values()) for place in {{kernel.place for kernel in chosen}}))
"""


def begin(cache: Path, script: str = COMPILE) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        python_command(script), env=environment_with(cache), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def lines_of(process: "subprocess.Popen[str]") -> list[list[str]]:
    output, errors = process.communicate(timeout=300)
    assert (process.returncode, errors) == (0, "")
    return [line.split() for line in output.splitlines()]


def test_two_processes_compile_once_and_both_see_how_far_it_is(tmp_path: Path) -> None:
    reports = [lines_of(process) for process in (begin(tmp_path), begin(tmp_path))]
    own = [lines for lines in reports if ["0", str(COUNT), "True"] in lines]
    assert len(own) == 1
    assert [line[0] for line in own[0] if line[2] == "True"] == [str(number) for number in range(COUNT + 1)]
    assert lines_of(begin(tmp_path, MISSES)) == [["0"]]


def test_a_process_that_is_killed_in_the_middle_leaves_the_rest_to_the_next(tmp_path: Path) -> None:
    first = begin(tmp_path)
    assert first.stdout is not None
    assert first.stdout.readline().split() == ["0", str(COUNT), "True"]
    wait_until(lambda: children_of(first.pid))
    compilers = children_of(first.pid)
    second = begin(tmp_path)
    first.kill()
    first.communicate()
    lines = lines_of(second)
    assert [str(COUNT), str(COUNT), "True"] in lines
    wait_until(lambda: not any(is_alive(pid) for pid in compilers))
    assert lines_of(begin(tmp_path, MISSES)) == [["0"]]


def test_compilers_that_are_killed_end_the_compilation_with_a_warning(tmp_path: Path) -> None:
    process = begin(tmp_path, COMPILE.rpartition("assert")[0])
    assert process.stdout is not None
    process.stdout.readline()
    wait_until(lambda: children_of(process.pid))
    for pid in children_of(process.pid):
        subprocess.run(["kill", "-9", str(pid)], check=True)
    _, errors = process.communicate(timeout=300)
    assert process.returncode == 0
    assert "kernels are compiled when they are called" in errors


def test_a_damaged_note_and_one_of_other_sources_count_as_none(tmp_path: Path) -> None:
    place = copy_kernels(tmp_path)
    place.write(frozenset(["draw"]), CompilationProgress(2, 2))
    assert (place.groups(), place.progress()) == ({"draw"}, CompilationProgress(2, 2))
    note = cache_folder(tmp_path) / "cleave-kernels.json"
    document = json.loads(note.read_text())
    for text in ("{", json.dumps(document | {"version": "0"})):
        note.write_text(text)
        assert (place.groups(), place.progress()) == (set(), None)


@pytest.mark.parametrize("ends", [True, False])
def test_the_lock_is_waited_for_until_all_is_done(tmp_path: Path, ends: bool) -> None:
    place, other = KernelPlace(tmp_path), KernelPlace(tmp_path)
    asked = 0
    with ExitStack() as holder:
        assert holder.enter_context(other.locked(lambda: False))

        def is_done() -> bool:
            nonlocal asked
            asked += 1
            if asked == 2 and not ends:
                holder.close()
            return ends and asked > 2

        with place.locked(is_done) as is_mine:
            assert is_mine is not ends
