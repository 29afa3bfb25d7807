"""The round trips of edits of a job; the service is otherwise idle."""

import statistics
import time
from collections.abc import Callable, Mapping
from typing import Any

import httpx

from bench.errors import BenchmarkError
from bench.load.meshes import wavy_torus

_PAUSE_S = 0.2  # while the mesh is being prepared

# An operation for the n-th edit of a mesh of so many faces.
EDITS: Mapping[str, Callable[[int, int], dict[str, Any]]] = {
    "name of a part": lambda n, _: {"op": "name", "part": 0, "name": f"part {n}"},
    "faces moved to a new part and merged back": lambda n, faces: (
        {"op": "merge", "parts": [0, 1]}
        if n % 2
        else {"op": "assign", "faces": {"starts": [n * faces // 100], "lengths": [faces // 20]}, "to": "new"}
    ),
    "part from a mark": lambda n, faces: {"op": "part", "inside": [(7919 * (n + 1)) % faces]},
    "borders smoothed": lambda *_: {"op": "smooth"},
}


def finished_job(client: httpx.Client, faces: int) -> tuple[str, int]:
    """Return the path of a finished job and its number of faces."""
    response = client.post("/v1/jobs", content=wavy_torus(faces), headers={"Content-Type": "model/ply"})
    path = str(response.headers["Location"])
    while True:
        document = client.get(path, params={"wait": 60}).json()
        if document["finished_at"] is not None:
            return path, document["mesh"]["faces"]


def edit_times(client: httpx.Client, path: str, operation: Callable[[int], dict[str, Any]], count: int) -> str:
    """Measure the first edit of a kind, with the preparation of the mesh if it needs one, and those that follow."""
    base = client.get(f"{path}/revisions").json()["newest"]
    times_s = []
    for number in range(count):
        body = {"base": base + number, "operations": [operation(number)]}
        began_at = time.perf_counter()
        while number == 0 and client.post(f"{path}/edits/preview", json=body).status_code == 503:
            time.sleep(_PAUSE_S)
        response = client.post(f"{path}/edits", json=body)
        times_s.append(time.perf_counter() - began_at)
        if response.status_code != 201:
            raise BenchmarkError(f"An edit was answered with {response.status_code}: {response.text[:200]}")
    return (
        f"first {1000 * times_s[0]:.0f} ms, median {1000 * statistics.median(times_s[1:]):.0f} ms, "
        f"largest {1000 * max(times_s[1:]):.0f} ms"
    )
