"""What `cleave serve` and `cleave worker` print at their start."""

import logging
import socket
from collections.abc import Mapping
from urllib.parse import urlsplit

from cleave.settings import Settings, unknown_variables
from service.host.listening import url_of
from worker.jobs.size_class import SizeClass

log = logging.getLogger("cleave.supervisor")


def warn_of_unknown_variables(environment: Mapping[str, str]) -> None:
    """Log the variables of an environment that look like settings and are none."""
    for name, nearest in unknown_variables(environment).items():
        meant = f"; the nearest one is {nearest}" if nearest else ""
        log.warning("the environment variable %s is no setting and has no effect%s", name, meant)


def announcement(
    settings: Settings,
    counts: Mapping[SizeClass, int],
    listening: socket.socket | None = None,
    *,
    own_queue: bool = False,
) -> str:
    """Return lines with the URL, the store, the data folder, the queue server and the number of workers.

    Parameters
    ----------
    counts : workers of each queue.
    listening : the socket of the service; None if only workers run.
    own_queue : whether the queue server is one that `cleave serve` starts.
    """
    workers = ", ".join(f"{count} for {size} jobs" for size, count in counts.items()) or "none"
    lines = {"data": str(settings.data_dir), "queue": _queue_name(settings, own_queue), "workers": workers}
    if settings.store_url is not None:
        lines = {"store": settings.store_url.partition("?")[0], **lines}
    if listening is not None:
        lines = {"listening on": url_of(listening), **lines}
    text = "\n".join(f"  {name:<13} {value}" for name, value in lines.items())
    return f"Cleave\n{text}\nCtrl-C stops it; jobs that are queued then run after the next start."


def _queue_name(settings: Settings, own_queue: bool) -> str:
    """Return the URL of the queue server without its user and password."""
    if own_queue:
        return "its own server, in the data folder"
    parts = urlsplit(settings.redis_url or "")
    return f"{parts.scheme}://{parts.hostname or ''}{f':{parts.port}' if parts.port else ''}{parts.path}"
