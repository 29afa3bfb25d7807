"""`python -m bench.load [NAME ...]`: the measurements of the service under load, or some of them.

busy     polls, uploads and memory while both workers segment; needs wrk
waiting  the overhead of Prefer: wait=10
levels   labels at any number of segments
"""

import sys
from collections.abc import Callable

import httpx

import segcore
from bench.load import measures
from bench.load.installation import installed

_POLLS_S = 60


def busy() -> None:
    # Three workers, of which two are for jobs of this size.
    with installed(workers=3) as installation, httpx.Client(base_url=installation.url, timeout=120) as client:
        path = measures.keep_busy(client, 60)[-1]
        _tell("status polls for 60 s", measures.polls(installation, path, _POLLS_S))
        _tell("upload to queued", measures.uploads(client, 60))
        _tell("memory of the service", measures.upload_memory(installation, client, 200))
        left = client.get(path).json()["status"]
        print(f"  (the workers were busy throughout: the last job is {left})")


def waiting() -> None:
    segcore.warm_up()
    with installed(workers=1) as installation, httpx.Client(base_url=installation.url, timeout=120) as client:
        _tell("Prefer: wait=10, 20,000 faces", measures.waiting(client, 20_000, 9))


def levels() -> None:
    with installed(workers=1) as installation, httpx.Client(base_url=installation.url, timeout=600) as client:
        for faces in (20_000, 1_000_000):
            for form in ("json", "raw"):
                _tell(f"segments=k, {faces} faces, {form}", measures.levels(client, faces, form))


_MEASURES: dict[str, Callable[[], None]] = {"busy": busy, "waiting": waiting, "levels": levels}


def _tell(name: str, found: str) -> None:
    print(f"| {name} | {found} |", flush=True)


def main() -> int:
    wanted = sys.argv[1:] or list(_MEASURES)
    unknown = [name for name in wanted if name not in _MEASURES]
    if unknown:
        print(f"There is no measurement {unknown[0]!r}: there are {', '.join(_MEASURES)}.", file=sys.stderr)
        return 2
    for name in wanted:
        _MEASURES[name]()
    return 0


if __name__ == "__main__":
    sys.exit(main())
