"""The service under load: response times and memory while workers are busy, and the overhead of waiting for a result.

busy     status polls, uploads and memory while both workers segment; needs wrk
waiting  the overhead of Prefer: wait=10
levels   labels at any number of segments
edits    the round trip of an edit, at 20,000 and 300,000 faces

Each measurement starts `cleave serve` with its own data folder. With --from, the other version is measured in turn with
this one in `waiting`, whose ratio is printed.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Callable
from functools import partial
from typing import Any

import httpx

from bench.checkout import HERE, version
from bench.errors import BenchmarkError
from bench.load import measures
from bench.load.edit_times import EDITS, edit_times, finished_job
from bench.load.installation import installed
from bench.load.waiting import Waiting, waiting

_POLLS_S = 60
_WAITING = "Prefer: wait=10, 20,000 faces"
_WAITING_FACES, _WAITING_JOBS = 20_000, 9


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"some of {', '.join(_MEASURES)} (default all, in this order)"
    )
    parser.add_argument(
        "--from", dest="previous", metavar="VERSION", help="a commit, or the folder of a checkout, to compare with"
    )


def run(arguments: argparse.Namespace) -> None:
    unknown = [name for name in arguments.names if name not in _MEASURES]
    if unknown:
        raise BenchmarkError(f"There is no measurement {unknown[0]!r}: there are {', '.join(_MEASURES)}.")
    for name in arguments.names or _MEASURES:
        if name == "waiting" and arguments.previous:
            _compare_waiting(arguments.previous)
        else:
            _MEASURES[name]()


def _busy() -> None:
    # Three workers, of which two run jobs of this size.
    with installed(workers=3) as installation, httpx.Client(base_url=installation.url, timeout=120) as client:
        path = measures.keep_busy(client, 60)[-1]
        _print(f"status polls for {_POLLS_S} s", measures.polls(installation, path, _POLLS_S))
        _print("status polls, as many as are answered", measures.most_polls(installation, path, _POLLS_S // 2))
        _print("upload to queued", measures.uploads(client, 60))
        _print("memory of the service", measures.upload_memory(installation, client, 200))
        left = client.get(path).json()["status"]
        print(f"  (the workers were busy throughout: the last job is {left})")


def _waiting() -> None:
    (found,) = waiting([HERE], _WAITING_FACES, _WAITING_JOBS)
    _print(_WAITING, str(found))


def _compare_waiting(previous: str) -> None:
    with version(previous) as root:
        this, other = waiting([HERE, root], _WAITING_FACES, _WAITING_JOBS)
    _print(f"{_WAITING}, this version", str(this))
    _print(f"{_WAITING}, {previous}", str(other))
    _print("ratio of the median overheads", f"{_median_overhead(this) / _median_overhead(other):.2f}")


def _median_overhead(found: Waiting) -> float:
    return statistics.median(found.overhead_ms)


def _levels() -> None:
    with installed(workers=1) as installation, httpx.Client(base_url=installation.url, timeout=600) as client:
        for faces in (20_000, 1_000_000):
            for form in ("json", "raw"):
                _print(f"segments=k, {faces} faces, {form}", measures.levels(client, faces, form))


def _edits() -> None:
    with installed(workers=1) as installation, httpx.Client(base_url=installation.url, timeout=600) as client:
        for wanted in (20_000, 300_000):
            path, faces = finished_job(client, wanted)
            for name, operation in EDITS.items():
                _print(f"{name}, {faces:,} faces", edit_times(client, path, partial(_of_mesh, operation, faces), 21))


def _of_mesh(operation: Callable[[int, int], dict[str, Any]], faces: int, number: int) -> dict[str, Any]:
    return operation(number, faces)


_MEASURES: dict[str, Callable[[], None]] = {
    "busy": _busy,
    "waiting": _waiting,
    "levels": _levels,
    "edits": _edits,
}


def _print(name: str, found: str) -> None:
    print(f"| {name} | {found} |", flush=True)
