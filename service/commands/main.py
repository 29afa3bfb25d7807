"""The command `cleave`."""

import argparse
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

from cleave.settings import InvalidSettings, load_settings
from service.commands.file_arguments import add_convert, add_fineness, add_inspect, add_outputs
from service.commands.operator_arguments import add_doctor, add_serve, add_worker
from service.commands.submit_arguments import add_submit
from service.host.kernel_cache import prepare_kernel_cache

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
        prepare_kernel_cache(lambda: load_settings(data_dir=getattr(choices, "data_dir", None)).data_dir)
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
    add_serve(commands, _say)
    add_worker(commands, _say)
    _add_segment(commands)
    add_convert(commands, _say)
    add_inspect(commands, _say)
    _add_submit(commands)
    _add_key(commands)
    add_doctor(commands, _say)
    return parser


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


# Each command imports what it needs when it runs: `cleave --help` does not wait for the numerics.


def _segment(choices: argparse.Namespace) -> None:
    from segcore.levels import Fineness
    from service.commands.outputs import output_options
    from service.commands.segment import SegmentRequest, segment_file

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
    from service.keys import is_owner_name, key_digest, new_key

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


def _say(text: str) -> None:
    print(text, flush=True)


def _expected_errors() -> tuple[type[Exception], ...]:
    from segcore.errors import CleaveError
    from service.commands.serve import CannotListen
    from service.host.queue_server import NoQueueServer
    from service.host.supervisor import DataInUse

    return CleaveError, InvalidSettings, NoQueueServer, CannotListen, DataInUse, OSError


def _sentence(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}." if error.filename else f"{error.strerror}."
    return " ".join(str(error).split())


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from cleave.version import installed_version

        _say(f"cleave {installed_version()}")
        parser.exit()
