"""`cleave worker`: run workers and a janitor for a service that runs elsewhere."""

import argparse
import os

from cleave.logs import configure_logging
from cleave.settings import Settings, load_settings
from service.commands.arguments import add_data_dir, add_settings_help, add_workers
from service.commands.console import say
from service.host.announcement import announcement, warn_of_unknown_variables
from service.host.programs import worker_counts, worker_programs
from service.host.queue_server import NoQueueServer, check_queue_server, queue_url
from service.host.supervisor import Supervisor
from worker.jobs.queue.connection import QueueError, connect
from worker.jobs.queue.workers import live_workers_here
from worker.jobs.size_class import SizeClass

_NO_WORKER = 1  # exit status of --check


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = "Run workers that share the data folder and the queue server of a service elsewhere."
    parser.add_argument("--redis-url", metavar="URL", help="the queue server, instead of CLEAVE_REDIS_URL")
    parser.add_argument(
        "--queue", choices=("small", "large", "both"), default="both", help="size of the jobs to run (%(default)s)"
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="run no worker, but report if workers of this machine are alive (for health checks)",
    )
    add_workers(parser, least=1)
    add_data_dir(parser)
    add_settings_help(parser)


def run(choices: argparse.Namespace) -> int | None:
    """Run workers for one queue or both until a signal arrives.

    Raises
    ------
    NoQueueServer
        If no queue server is set.
    """
    settings = load_settings(redis_url=choices.redis_url, data_dir=choices.data_dir)
    if choices.check:
        return _check(settings)
    configure_logging(settings.log_level, settings.log_format, "supervisor")
    warn_of_unknown_variables(os.environ)
    if settings.redis_url is None:
        raise NoQueueServer("A worker needs the queue server of its service: set CLEAVE_REDIS_URL or give --redis-url.")
    check_queue_server(settings.redis_url)
    counts = worker_counts(choices.workers, None if choices.queue == "both" else SizeClass(choices.queue))
    supervisor = Supervisor(worker_programs(settings, counts))
    say(announcement(settings, counts))
    supervisor.run()
    return None


def _check(settings: Settings) -> int:
    """Print the workers of this machine that are alive."""
    try:
        with connect(queue_url(settings)) as connection:
            alive = live_workers_here(connection)
    except QueueError as error:
        say(f"The queue server does not answer: {error}.")
        return _NO_WORKER
    say(f"Workers alive on this machine: {', '.join(alive) or 'none'}.")
    return 0 if alive else _NO_WORKER
