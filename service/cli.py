"""The command `cleave`."""

import argparse
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

from service.cli_submit import add_submit
from service.file_commands import add_convert, add_fineness, add_inspect, add_outputs
from service.kernel_cache import prepare_kernel_cache
from worker.logs import configure_logging
from worker.settings import InvalidSettings, Settings, load_settings

_DESCRIPTION = """\
Cuts a 3D mesh into the parts that a person would name.

  cleave serve                          an HTTP service with its workers, on http://127.0.0.1:8000
  cleave segment hand.off -o parts.glb  one mesh, without a server
  cleave convert hand.cleave -o a.ply   a stored result in another format
  cleave inspect hand.off               what is in a mesh file
  cleave submit *.off -o results        many meshes, on a server
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; what was expected to go wrong is one line and exit status 2."""
    choices = _parser().parse_args(arguments)
    try:
        prepare_kernel_cache(lambda: load_settings().data_dir)
        return choices.run(choices) or 0
    except KeyboardInterrupt:
        return 130
    except _expected_errors() as error:
        print(f"cleave: {_sentence(error)}", file=sys.stderr)
        return 2


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(2, f"cleave: {message}; {self.prog} --help shows what there is.\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="cleave", description=_DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    _add_serve(commands)
    _add_worker(commands)
    _add_segment(commands)
    add_convert(commands, _say)
    add_inspect(commands, _say)
    _add_submit(commands)
    _add_key(commands)
    _add_doctor(commands)
    return parser


def _add_serve(commands: "argparse._SubParsersAction[_Parser]") -> None:
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
    serve.set_defaults(run=_serve)


def _add_worker(commands: "argparse._SubParsersAction[_Parser]") -> None:
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
    worker.set_defaults(run=_work)


def _add_workers(parser: argparse.ArgumentParser, least: int) -> None:
    parser.add_argument(
        "--workers",
        type=_at_least(least),
        metavar="N",
        help="jobs at a time: one less than cores, but one small and one large job at least",
    )
    parser.add_argument("--data-dir", type=Path, metavar="DIR", help="the data folder, in place of CLEAVE_DATA_DIR")


def _add_segment(commands: "argparse._SubParsersAction[_Parser]") -> None:
    segment = commands.add_parser(
        "segment",
        help="segment one mesh without a server",
        description="Segment one mesh and write what is asked for; without outputs only a summary is printed.",
    )
    segment.add_argument("mesh", type=Path, metavar="MESH", help="the mesh file")
    add_fineness(segment, "chosen by the mesh")
    segment.add_argument("--max-segments", type=int, metavar="N", help="how far the hierarchy goes (64, or K)")
    segment.add_argument("--preset", metavar="NAME", help="a published method, such as chahhou2014")
    segment.add_argument(
        "--set",
        type=_parameter,
        action="append",
        default=[],
        dest="parameters",
        metavar="NAME=VALUE",
        help="a parameter of the method, such as solver=inverse_power; may be given again",
    )
    add_outputs(segment)
    segment.add_argument("--labels", type=Path, metavar="LABELS.seg", help="the segment of every face, one per line")
    segment.add_argument("--hierarchy", type=Path, metavar="TREE.json", help="the tree of cuts")
    segment.add_argument("--result", type=Path, metavar="MESH.cleave", help="mesh and tree, to be opened again")
    segment.set_defaults(run=_segment)


def _add_submit(commands: "argparse._SubParsersAction[_Parser]") -> None:
    submit = commands.add_parser(
        "submit",
        help="segment many meshes on a server",
        description="Submit mesh files to a service and save their results. A second run goes on where the first broke "
        "off. The environment variable CLEAVE_API_KEY has the API key, where the service requires one.",
        epilog="exit status: 0 all done, 1 some files failed, 2 nothing was tried, 130 interrupted",
    )
    add_submit(submit, _parameter)


def _add_key(commands: "argparse._SubParsersAction[_Parser]") -> None:
    key = commands.add_parser(
        "key",
        help="make an API key",
        description="Make an API key for somebody. The key itself is shown once and kept nowhere.",
    )
    key.add_argument("name", metavar="NAME", help="whose it is: lower-case letters, digits and dashes")
    key.set_defaults(run=_key)


def _add_doctor(commands: "argparse._SubParsersAction[_Parser]") -> None:
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
    doctor.set_defaults(run=_examine)


# Each command imports what it needs when it runs: `cleave --help` does not wait for the numerics.


def _serve(choices: argparse.Namespace) -> None:
    from service.serve_command import serve

    _configure_logging()
    serve(choices.host, choices.port, choices.workers, choices.data_dir, _say)


def _work(choices: argparse.Namespace) -> int | None:
    if choices.check:
        from service.doctor_command import check_workers

        return check_workers(load_settings(redis_url=choices.redis_url, data_dir=choices.data_dir), _say)
    from service.serve_command import work
    from worker.size_class import SizeClass

    _configure_logging()
    only = None if choices.queue == "both" else SizeClass(choices.queue)
    work(choices.redis_url, choices.workers, choices.data_dir, _say, only)
    return None


def _segment(choices: argparse.Namespace) -> None:
    from service.fineness import Fineness
    from service.outputs import output_options
    from service.segment_command import SegmentRequest, segment_file

    summary = segment_file(
        SegmentRequest(
            mesh=choices.mesh,
            fineness=Fineness(choices.segments, choices.granularity),
            parameters=dict(choices.parameters)
            | ({} if choices.preset is None else {"preset": choices.preset})
            | ({} if choices.max_segments is None else {"max_segments": choices.max_segments}),
            outputs=tuple(choices.output),
            options=output_options(choices),
            labels=choices.labels,
            hierarchy=choices.hierarchy,
            result=choices.result,
        )
    )
    _say("\n".join(summary))


def _key(choices: argparse.Namespace) -> None:
    from service.api_keys import is_owner_name, key_digest, new_key

    if not is_owner_name(choices.name):
        raise InvalidSettings("The name of a key has 1 to 32 lower-case letters, digits and dashes.")
    key = new_key()
    _say(f"key    {key}")
    _say(f"entry  {choices.name}:{key_digest(key)}")
    _say(f"Give the key to {choices.name}, and the entry to CLEAVE_API_KEYS_FILE.")


def _parameter(text: str) -> tuple[str, object]:
    """A name and a value: a number where it reads as one, otherwise a word."""
    name, equals, value = text.partition("=")
    if not name or not equals:
        raise argparse.ArgumentTypeError(f"a parameter is NAME=VALUE, not {text!r}")
    for number in (int, float):
        with suppress(ValueError):
            return name, number(value)
    return name, value


def _examine(choices: argparse.Namespace) -> int:
    from service.doctor_command import examine

    return examine(load_settings(data_dir=choices.data_dir), choices.host, in_json=choices.json, say=_say)


def _configure_logging() -> None:
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, "supervisor")


def _say(text: str) -> None:
    print(text, flush=True)


def _expected_errors() -> tuple[type[Exception], ...]:
    from segcore.errors import CleaveError
    from service.queue_server import NoQueueServer
    from service.serve_command import CannotListen
    from service.supervisor import DataInUse

    return CleaveError, InvalidSettings, NoQueueServer, CannotListen, DataInUse, OSError


def _sentence(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}." if error.filename else f"{error.strerror}."
    return " ".join(str(error).split())


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from service.app import installed_version

        _say(f"cleave {installed_version()}")
        parser.exit()


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


if __name__ == "__main__":
    sys.exit(main())
