"""`cleave doctor` and `cleave worker --check`: how an installation is, for people, scripts and health checks."""

import os
from collections.abc import Callable

from cleave.settings import Settings
from service.doctor.findings import Finding, as_json, as_text, has_errors, warning
from service.doctor.machine_checks import check_machine
from service.doctor.queue_checks import check_queue
from service.doctor.store_checks import check_store
from service.host.queue_server import embedded_queue_server
from worker.jobs.queue.connection import QueueError, connect
from worker.jobs.queue.workers import live_workers_here

Say = Callable[[str], None]


def examine(settings: Settings, host: str, *, in_json: bool, say: Say) -> int:
    """Look at everything and tell it; the exit status is 1 where something has to be mended."""
    findings = [*_queue(settings), *check_store(settings), *check_machine(settings, host)]
    say(as_json(findings) if in_json else as_text(findings))
    return 1 if has_errors(findings) else 0


def check_workers(settings: Settings, say: Say) -> int:
    """Tell whether workers of this machine are alive; the exit status is 1 where none is."""
    try:
        with connect(_queue_url(settings)) as connection:
            alive = live_workers_here(connection)
    except QueueError as error:
        say(f"The queue server does not answer: {error}.")
        return 1
    say(f"Workers alive on this machine: {', '.join(alive) or 'none'}.")
    return 0 if alive else 1


def _queue(settings: Settings) -> list[Finding]:
    if settings.redis_url is None and not os.path.exists(_queue_url(settings).removeprefix("unix://")):
        return [
            warning(
                "queue server",
                "none is named, and `cleave serve` does not run here with one of its own.",
                "Start `cleave serve`, or set CLEAVE_REDIS_URL.",
            )
        ]
    return check_queue(_queue_url(settings))


def _queue_url(settings: Settings) -> str:
    """The server that is named, or the one that `cleave serve` brings along.

    Raises
    ------
    NoQueueServer
        Where there can be none.
    """
    return settings.redis_url or embedded_queue_server(settings.data_dir).url
