"""Measures one segmentation of a dumbbell: ``python bench/scale/probe.py FACES THREADS``, and prints JSON.

The file can be run by another version of Cleave, of which it needs ``segcore`` and ``bench.memory``.
"""

import inspect
import json
import sys
import time
from typing import Any

from bench.memory import peak_memory, reset_peak
from segcore.method import segment
from segcore.shapes import dumbbell
from segcore.warm_up import warm_up


def main(arguments: list[str]) -> None:
    faces, threads = map(int, arguments)
    warm_up()
    around = max(3, round((faces / 4) ** 0.5))
    mesh = dumbbell(rings=max(2, round(faces / (2 * around))), around=around).mesh
    choice: dict[str, Any] = {"threads": threads} if "threads" in inspect.signature(segment).parameters else {}
    before, wall, cpu = reset_peak(), time.perf_counter(), time.process_time()
    segment(mesh, **choice)
    wall_s, cpu_s = time.perf_counter() - wall, time.process_time() - cpu
    cost = {"faces": len(mesh.faces), "cpu_s": cpu_s, "wall_s": wall_s, "memory_bytes": peak_memory() - before}
    print(json.dumps(cost))


if __name__ == "__main__":
    main(sys.argv[1:])
