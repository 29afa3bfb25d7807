"""`cleave serve` and `cleave worker`: the processes of an installation under one supervisor."""

import ipaddress
import os
import socket
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from urllib.parse import urlsplit

from cleave.settings import InvalidSettings, Settings, load_settings
from service.host.programs import api_program, queue_server_program, worker_programs
from service.host.queue_server import NoQueueServer, embedded_queue_server, stop_orphan
from service.host.supervisor import Program, Supervisor, lock_data
from service.keys import key_ring
from worker.jobs.size_class import SizeClass
from worker.jobs.store.opening import open_store

Say = Callable[[str], None]  # tells the person who gave the command

_BACKLOG = 1024


class CannotListen(Exception):  # noqa: N818
    """The address cannot be listened on; the message says why."""


def serve(host: str, port: int, workers: int | None, data_dir: Path | None, say: Say) -> None:
    """Run the service, its workers and, where no other is named, its queue server, until a signal comes."""
    settings = load_settings(data_dir=data_dir)
    counts = worker_counts(workers)
    with ExitStack() as stack:
        listening = stack.enter_context(listen(host, port))
        check_guarded(settings, listening.getsockname()[0])
        stack.enter_context(lock_data(settings.data_dir))
        open_store(settings).check_writable()
        support: list[Program] = []
        if settings.redis_url is None:
            server = embedded_queue_server(settings.data_dir)
            stop_orphan(server)
            stack.callback(server.clear_away)
            settings = settings.model_copy(update={"redis_url": server.url})
            support = [queue_server_program(server)]
        say(_announcement(settings, counts, listening, own_queue=bool(support)))
        programs = [*support, api_program(settings, listening.fileno()), *worker_programs(settings, counts)]
        Supervisor(programs).run()


def work(
    redis_url: str | None, workers: int | None, data_dir: Path | None, say: Say, only: SizeClass | None = None
) -> None:
    """Run workers, for one of the queues or for both, and a janitor against a queue server that runs elsewhere."""
    settings = load_settings(redis_url=redis_url, data_dir=data_dir)
    if settings.redis_url is None:
        raise NoQueueServer("A worker needs the queue server of its service: set CLEAVE_REDIS_URL or give --redis-url.")
    counts = worker_counts(workers, only)
    say(_announcement(settings, counts, None, own_queue=False))
    Supervisor(worker_programs(settings, counts)).run()


def check_guarded(settings: Settings, address: str) -> None:
    """Refuse to serve strangers by oversight.

    Raises
    ------
    InvalidSettings
        Where API keys are required, by the settings or because others can reach the address, and there are none.
    """
    has_keys = bool(key_ring(settings).all())
    if has_keys or settings.auth == "off":
        return
    if settings.auth == "required":
        raise InvalidSettings("CLEAVE_AUTH requires API keys and there are none: make one with `cleave key NAME`.")
    if not ipaddress.ip_address(address).is_loopback:
        raise InvalidSettings(
            f"Others can reach {address}: make API keys with `cleave key NAME`, or set CLEAVE_AUTH=off where something "
            "else keeps strangers out."
        )


def worker_counts(workers: int | None, only: SizeClass | None = None) -> dict[SizeClass, int]:
    """How many workers each queue gets of a number of them; where none is said, one core is left for answering.

    A quarter is for the large jobs. No queue that is served goes without a worker, so there may be one more than said.
    """
    total = max(1, _cores() - 1) if workers is None else workers
    if only is not None or total == 0:
        return {size: total for size in SizeClass if size == only}
    large = max(1, total // 4)
    return {SizeClass.SMALL: max(1, total - large), SizeClass.LARGE: large}


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def listen(host: str, port: int) -> socket.socket:
    """A listening socket; a port of 0 is one that is free.

    Raises
    ------
    CannotListen
        Where the host is not an address of this machine, or the port is taken.
    """
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        return socket.create_server(address[:2], family=family, backlog=_BACKLOG)
    except OSError as error:
        raise CannotListen(f"Cannot listen on {host} port {port}: {error.strerror}.") from error


def _announcement(
    settings: Settings, counts: Mapping[SizeClass, int], listening: socket.socket | None, *, own_queue: bool
) -> str:
    """Where everything is."""
    workers = ", ".join(f"{count} for {size} jobs" for size, count in counts.items()) or "none"
    lines = {"data": str(settings.data_dir), "queue": _queue_name(settings, own_queue), "workers": workers}
    if settings.store_url is not None:
        lines = {"store": settings.store_url.partition("?")[0], **lines}
    if listening is not None:
        lines = {"listening on": _url(listening), **lines}
    text = "\n".join(f"  {name:<13} {value}" for name, value in lines.items())
    return f"Cleave\n{text}\nCtrl-C stops it; what is queued then is finished after the next start."


def _url(listening: socket.socket) -> str:
    host, port = listening.getsockname()[:2]
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def _queue_name(settings: Settings, own_queue: bool) -> str:
    if own_queue:
        return "a server of its own, in the data folder"
    parts = urlsplit(settings.redis_url or "")
    return f"{parts.scheme}://{parts.hostname or ''}{f':{parts.port}' if parts.port else ''}{parts.path}"
