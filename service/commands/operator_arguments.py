"""The commands of `cleave` for who runs an installation: serve, worker, doctor."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from cleave.logs import configure_logging
from cleave.settings import Settings, load_settings

if TYPE_CHECKING:
    from service.commands.file_arguments import Commands

Say: TypeAlias = Callable[[str], None]


def add_serve(commands: "Commands", say: Say) -> None:
    serve = commands.add_parser(
        "serve",
        help="run the service, its workers and its queue",
        description="Run the service, its workers and, unless CLEAVE_REDIS_URL names one, its own queue server.",
        epilog=_settings_help(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    serve.add_argument("--host", default="127.0.0.1", help="address to listen on (%(default)s)")
    serve.add_argument("--port", type=_port, default=8000, help="port to listen on, 0 for a free one (%(default)s)")
    _add_workers(serve, least=0)
    serve.set_defaults(run=lambda choices: _serve(choices, say))


def add_worker(commands: "Commands", say: Say) -> None:
    worker = commands.add_parser(
        "worker",
        help="run workers for a service elsewhere",
        description="Run workers that share the data folder and the queue server of a service elsewhere.",
        epilog=_settings_help(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    worker.add_argument("--redis-url", metavar="URL", help="the queue server, in place of CLEAVE_REDIS_URL")
    worker.add_argument(
        "--queue", choices=("small", "large", "both"), default="both", help="the jobs to work for (%(default)s)"
    )
    worker.add_argument(
        "--check",
        action="store_true",
        help="run none, but say whether workers of this machine are alive (for health checks)",
    )
    _add_workers(worker, least=1)
    worker.set_defaults(run=lambda choices: _work(choices, say))


def _add_workers(parser: argparse.ArgumentParser, least: int) -> None:
    parser.add_argument(
        "--workers",
        type=_at_least(least),
        metavar="N",
        help="jobs at a time: one less than cores, but one small and one large job at least",
    )
    parser.add_argument("--data-dir", type=Path, metavar="DIR", help="the data folder, in place of CLEAVE_DATA_DIR")


def add_doctor(commands: "Commands", say: Say) -> None:
    doctor = commands.add_parser(
        "doctor",
        help="check an installation and say what to mend",
        description="Check the queue server, the store, the workers and this machine against the settings, and say "
        "what to mend.",
        epilog="exit status: 0 nothing has to be mended, 1 something has, 2 the settings cannot be used",
    )
    doctor.add_argument("--host", default="127.0.0.1", help="the address that the service listens on (%(default)s)")
    doctor.add_argument("--data-dir", type=Path, metavar="DIR", help="the data folder, in place of CLEAVE_DATA_DIR")
    doctor.add_argument("--json", action="store_true", help="tell it as JSON")
    doctor.set_defaults(run=lambda choices: _examine(choices, say))


# Each command imports what it needs when it runs: `cleave --help` does not wait for the numerics.


def _serve(choices: argparse.Namespace, say: Say) -> None:
    from service.commands.serve import serve

    _configure_logging()
    serve(choices.host, choices.port, choices.workers, choices.data_dir, say)


def _work(choices: argparse.Namespace, say: Say) -> int | None:
    if choices.check:
        from service.commands.doctor import check_workers

        return check_workers(load_settings(redis_url=choices.redis_url, data_dir=choices.data_dir), say)
    from service.commands.serve import work
    from worker.jobs.size_class import SizeClass

    _configure_logging()
    only = None if choices.queue == "both" else SizeClass(choices.queue)
    work(choices.redis_url, choices.workers, choices.data_dir, say, only)
    return None


def _examine(choices: argparse.Namespace, say: Say) -> int:
    from service.commands.doctor import examine

    return examine(load_settings(data_dir=choices.data_dir), choices.host, in_json=choices.json, say=say)


def _configure_logging() -> None:
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, "supervisor")


def _settings_help() -> str:
    rows = [(f"CLEAVE_{name.upper()}", field.description or "") for name, field in Settings.model_fields.items()]
    return "settings from the environment:\n" + "\n".join(f"  {name:<26} {text}" for name, text in rows)


def _port(text: str) -> int:
    number = int(text)
    if not 0 <= number <= 65535:
        raise argparse.ArgumentTypeError("a port is a number from 0 to 65535")
    return number


def _at_least(least: int) -> Callable[[str], int]:
    def number(text: str) -> int:
        value = int(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"must be at least {least}")
        return value

    return number
