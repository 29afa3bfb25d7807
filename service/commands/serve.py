"""`cleave serve`: run the service, its workers and its queue server."""

import argparse
import os
from contextlib import ExitStack

from cleave.logs import configure_logging
from cleave.settings import Settings, load_settings
from service.commands.arguments import add_data_dir, add_settings_help, add_workers, port
from service.commands.console import say
from service.guard.exposure import check_exposure
from service.host.announcement import announcement, warn_of_unknown_variables
from service.host.listening import listen
from service.host.programs import api_program, queue_server_program, worker_counts, worker_programs
from service.host.queue_server import QueueServer, check_queue_server, embedded_queue_server, stop_orphan
from service.host.start_signal import StartSignal
from service.host.supervisor import Supervisor, lock_data
from worker.jobs.store.opening import open_store


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = "Run the service, its workers and, unless CLEAVE_REDIS_URL is set, its own queue server."
    parser.add_argument("--host", default="127.0.0.1", help="address to listen on (%(default)s)")
    parser.add_argument("--port", type=port, default=8000, help="port to listen on, 0 for a free one (%(default)s)")
    parser.add_argument(
        "--root-path", metavar="PATH", help="path below which a proxy shows the service (CLEAVE_ROOT_PATH)"
    )
    add_workers(parser, least=0)
    add_data_dir(parser)
    add_settings_help(parser)


def run(choices: argparse.Namespace) -> None:
    """Run the processes of an installation until a signal arrives."""
    settings = load_settings(data_dir=choices.data_dir, root_path=choices.root_path)
    configure_logging(settings.log_level, settings.log_format, "supervisor")
    warn_of_unknown_variables(os.environ)
    counts = worker_counts(choices.workers)
    with ExitStack() as stack:
        listening = stack.enter_context(listen(choices.host, choices.port))
        check_exposure(settings, listening.getsockname()[0])
        stack.enter_context(lock_data(settings.data_dir))
        open_store(settings).check_writable()
        server = _own_queue_server(settings, stack)
        if server is not None:
            settings = settings.model_copy(update={"redis_url": server.url})
        queue = [] if server is None else [queue_server_program(server)]
        started = StartSignal()
        api = api_program(settings, listening.fileno(), started)
        supervisor = Supervisor([*queue, api, *worker_programs(settings, counts, started.has_come)])
        say(announcement(settings, counts, listening, own_queue=server is not None))
        supervisor.run()


def _own_queue_server(settings: Settings, stack: ExitStack) -> QueueServer | None:
    """Return the queue server to start; None if the settings name another one. The stack removes its socket."""
    if settings.redis_url is not None:
        check_queue_server(settings.redis_url)
        return None
    server = embedded_queue_server(settings.data_dir)
    stop_orphan(server)
    stack.callback(server.remove_socket)
    return server
