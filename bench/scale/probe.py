"""Measures one segmentation of a dumbbell: ``python bench/scale/probe.py FACES THREADS``, and prints JSON.

The file can be run by another version of Cleave, of which it needs ``segcore`` and ``bench.memory``.
"""

import inspect
import json
import signal
import sys
import time
from collections import defaultdict
from pathlib import Path
from types import FrameType
from typing import Any

import segcore
from bench.memory import peak_memory, reset_peak
from segcore.shapes import dumbbell

_STEP_S = 0.002  # processor time between two looks at the stack
_ROOT = f"{Path(segcore.__file__).parent}/"


class Lines:
    """The CPU seconds of the process, by the line of segcore that the main thread is at.

    A signal is handled after the call that it interrupts, and all that has passed since the last one is that line's.
    """

    def __init__(self) -> None:
        self.seconds: defaultdict[str, float] = defaultdict(float)
        self._last = time.process_time()

    def __enter__(self) -> "Lines":
        signal.signal(signal.SIGPROF, self._look)
        signal.setitimer(signal.ITIMER_PROF, _STEP_S, _STEP_S)
        return self

    def __exit__(self, *_: object) -> None:
        signal.setitimer(signal.ITIMER_PROF, 0)

    def _look(self, _signal: int, frame: FrameType | None) -> None:
        then, self._last = self._last, time.process_time()
        while frame is not None and not _is_own(frame):
            frame = frame.f_back
        if frame is not None:
            line = f"{frame.f_code.co_filename.removeprefix(_ROOT)}:{frame.f_lineno}"
            self.seconds[line] += self._last - then


def _is_own(frame: FrameType) -> bool:
    """Whether a frame is in segcore, and does more than to give blocks to threads."""
    name = frame.f_code.co_filename
    return name.startswith(_ROOT) and name != f"{_ROOT}threads.py"


def main(arguments: list[str]) -> None:
    faces, threads = map(int, arguments)
    segcore.warm_up()
    around = max(3, round((faces / 4) ** 0.5))
    mesh = dumbbell(rings=max(2, round(faces / (2 * around))), around=around).mesh
    choice: dict[str, Any] = {"threads": threads} if "threads" in inspect.signature(segcore.segment).parameters else {}
    peaks = {"before": reset_peak()}
    stage = ["before"]

    def on_progress(name: str, _: float) -> None:
        peaks[stage[0]] = max(peaks.get(stage[0], 0), peak_memory())
        reset_peak()
        stage[0] = name

    wall, cpu = time.perf_counter(), time.process_time()
    with Lines() as lines:
        segcore.segment(mesh, on_progress=on_progress, **choice)
    wall_s, cpu_s = time.perf_counter() - wall, time.process_time() - cpu
    start = peaks.pop("before")
    memory = {name: peak - start for name, peak in peaks.items()}
    print(
        json.dumps(
            {
                "faces": len(mesh.faces),
                "cpu_s": cpu_s,
                "wall_s": wall_s,
                "memory_bytes": memory,
                "line_s": dict(lines.seconds),
            }
        )
    )


if __name__ == "__main__":
    main(sys.argv[1:])
