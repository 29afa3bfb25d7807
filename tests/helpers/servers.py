"""The application on a real server in a thread of the tests, and a thread that runs its jobs."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import uvicorn

from cleave.settings import Settings
from service.app import create_app
from service.host.http_server import server_config
from worker.jobs.store.store import JobStore
from worker.process.perform import perform


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
            for job_id in store.pending.all():
                perform(store, settings, job_id, lambda *_: None)

    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()
