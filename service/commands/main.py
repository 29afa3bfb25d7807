"""The command `cleave`: import the module of the given command, parse its arguments and run it.

A command is a module of this package with the functions ``add_arguments(parser)`` and ``run(choices)``, and an entry
in ``COMMANDS``. Only the module of the given command is imported: `cleave --help` does not wait for numpy and numba.
"""

import argparse
import atexit
import gc
import io
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from textwrap import fill
from typing import NoReturn

from service.commands.console import say, say_beside
from service.host.kernel_cache import prepare_kernel_cache

COMMANDS = {
    "serve": "run the service, its workers and its queue",
    "worker": "run workers for a service elsewhere",
    "segment": "segment one mesh without a server",
    "edit": "edit the parts in a .cleave file",
    "convert": "write a .cleave file in other formats",
    "inspect": "report what a mesh file contains",
    "submit": "segment many meshes on a server",
    "mcp": "give an agent tools to see, name and edit parts",
    "key": "make an API key",
    "doctor": "check an installation and report what to fix",
    "completion": "print the completion script of a shell",
}

_NOT_DONE = "the arguments, the settings or a file cannot be used, and one line says why"
_CANNOT_START = "it cannot start, and one line says why"
# What the exit statuses of each command mean, for its help and docs/reference/cli.md. Every command but serve and
# worker, which end with 0 then, ends with 130 if Ctrl-C interrupts it.
EXIT_STATUSES = {
    "serve": {0: "stopped by Ctrl-C or SIGTERM", 2: _CANNOT_START},
    "worker": {
        0: "stopped by Ctrl-C or SIGTERM; with --check: workers of this machine are alive",
        1: "with --check: none is alive, or the queue server does not answer",
        2: _CANNOT_START,
    },
    "segment": {0: "done", 2: _NOT_DONE},
    "edit": {0: "done", 2: _NOT_DONE},
    "convert": {0: "done", 2: _NOT_DONE},
    "inspect": {0: "done", 2: _NOT_DONE},
    "submit": {
        0: "every file has its results",
        1: "some files failed",
        2: "nothing was tried: the arguments, the server or the folder cannot be used",
    },
    "mcp": {0: "the agent has closed the connection", 2: _CANNOT_START},
    "key": {0: "done", 2: "the name cannot be used"},
    "doctor": {0: "nothing has to be fixed", 1: "something has", 2: "the settings cannot be used"},
    "completion": {0: "done", 2: "the shell is not known, or the extra completion is missing"},
}
INTERRUPTED = 130  # 128 + SIGINT, as shells report it

_HELP_WIDTH = 78
_EVERY = "*"  # in place of the name of a command

_DESCRIPTION = """\
Cuts a 3D mesh into the parts that a person would name.

  cleave serve                          an HTTP service with its workers, on http://127.0.0.1:8000
  cleave segment hand.off -o parts.glb  one mesh, without a server
  cleave edit hand.cleave --operations edits.json
                                        its parts merged, cut and named
  cleave convert hand.cleave -o a.ply   a stored result in another format
  cleave inspect hand.off               what a mesh file contains
  cleave submit *.off -o results        many meshes, on a server
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit status. Expected errors print one line and return 2."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # the names of files may be no text that it can show
    try:
        choices = _parser(words).parse_args(words)
        return choices.run(choices) or 0
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        if not isinstance(error, _expected_errors()):
            raise
        say_beside(f"cleave: {_sentence(error)}")
        return 2


def command() -> NoReturn:
    """Run a command in a process of its own, and end the process.

    The exit functions are run, but modules and compiled kernels are not taken apart, which would take a tenth of the
    time of a short command. Neither does the collector of garbage look at what the imports have made.
    """
    gc.set_threshold(50_000, 20, 50)
    status = main()
    for stream in (sys.stdout, sys.stderr):
        with suppress(BrokenPipeError):
            stream.flush()
    atexit._run_exitfuncs()
    os._exit(status)


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        say_beside(f"cleave: {message}; see {self.prog} --help.")
        self.exit(2)


def _parser(words: Sequence[str]) -> _Parser:
    """Return a parser of every command name and of the arguments of the command that is given."""
    parser = _Parser(prog="cleave", description=_DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    given = next((word for word in words if not word.startswith("-")), None)
    for name, summary in COMMANDS.items():
        command = commands.add_parser(name, help=summary)
        if given in (name, _EVERY):
            _prepare_kernel_cache(words)
            module = import_module(f"service.commands.{name}")
            module.add_arguments(command)
            command.epilog = "\n\n".join(filter(None, [command.epilog, _exit_statuses(name)]))
            command.description = fill(command.description or "", _HELP_WIDTH)
            command.formatter_class = argparse.RawDescriptionHelpFormatter  # keeps the lines of the epilog
            command.set_defaults(run=module.run)
    return parser


def _exit_statuses(name: str) -> str:
    """Return the last lines of the help of a command."""
    statuses = (
        EXIT_STATUSES[name] if name in ("serve", "worker") else {**EXIT_STATUSES[name], INTERRUPTED: "interrupted"}
    )
    return "exit status:\n" + "\n".join(f"  {status:<4} {meaning}" for status, meaning in statuses.items())


def complete_parser() -> argparse.ArgumentParser:
    """Return a parser of every command with its arguments."""
    return _parser([_EVERY])


def _prepare_kernel_cache(words: Sequence[str]) -> None:
    """Choose the cache of numba, which must be done before a command imports a kernel.

    The cache may be in the data folder, so ``--data-dir`` is read ahead of the other arguments.
    """
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--data-dir", type=Path, nargs="?")
    data_dir = parser.parse_known_args(words)[0].data_dir
    prepare_kernel_cache(partial(_data_dir, data_dir))


def _data_dir(given: Path | None) -> Path:
    from cleave.settings import load_settings

    return load_settings(data_dir=given).data_dir


def _expected_errors() -> tuple[type[Exception], ...]:
    from cleave.settings import InvalidSettings
    from segcore.errors import CleaveError
    from service.host.listening import CannotListen
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

        say(f"cleave {installed_version()}")
        parser.exit()
