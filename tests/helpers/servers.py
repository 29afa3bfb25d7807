"""The application on a real server in a thread of the tests, a thread that runs its jobs, and their segmentations."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import httpx
import pytest
import uvicorn

import segcore
from cleave.settings import Settings
from helpers.jobs import unfinished
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh
from segcore.parameters import SegmentationParameters
from segcore.progress import OnProgress
from service.app import create_app
from service.host.http_server import server_config
from worker.jobs.store.store import JobStore
from worker.process.perform import perform

_MOST_FACES = 5_000  # larger meshes are segmented each time

_compute = segcore.segment
_known: dict[object, tuple[Hierarchy, list[tuple[str, float]]]] = {}


@contextmanager
def serving(settings: Settings) -> Iterator[httpx.Client]:
    """Serve an application from a thread; yield a client of it."""
    # From a descriptor, as in service.host.http_server: asyncio sets TCP_NODELAY only if the protocol is known.
    listening = socket.socket(fileno=socket.create_server(("127.0.0.1", 0)).detach())
    server = uvicorn.Server(server_config(create_app(settings)))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    try:
        with httpx.Client(base_url=f"http://127.0.0.1:{listening.getsockname()[1]}", timeout=30) as client:
            yield client
    finally:
        server.should_exit = True
        thread.join()
        listening.close()


@contextmanager
def working(store: JobStore, settings: Settings) -> Iterator[None]:
    """Run the jobs of a store in a thread."""
    stop = threading.Event()

    def work() -> None:
        while not stop.wait(0.01):
            for job_id in unfinished(store):
                perform(store, settings, job_id, lambda *_: None)

    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


@contextmanager
def remembered_segmentations() -> Iterator[None]:
    """Let ``segcore.segment`` give the hierarchy, and the progress, of the first time if it gets a small mesh again.

    Kernels are warmed up once, too.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(segcore, "warm_up", cache(segcore.warm_up))
        patch.setattr(segcore, "segment", _segment)
        yield


def _segment(
    mesh: Mesh,
    parameters: SegmentationParameters | None = None,
    on_progress: OnProgress = lambda *_: None,
    surface: Any = None,
    threads: int | None = None,
) -> Hierarchy:
    chosen = parameters or SegmentationParameters()
    if chosen.structure != "none" or len(mesh.faces) > _MOST_FACES:
        return _compute(mesh, chosen, on_progress, surface, threads)
    key = mesh.vertices.tobytes(), mesh.faces.tobytes(), chosen, threads
    if key not in _known:
        steps: list[tuple[str, float]] = []
        _known[key] = _compute(mesh, chosen, lambda *step: steps.append(step), surface, threads), steps
    hierarchy, steps = _known[key]
    for step in steps:
        on_progress(*step)
    return hierarchy
