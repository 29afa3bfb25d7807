"""``python -m bench COMMAND``: run a benchmark; without a command, list them."""

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from pkgutil import iter_modules

from bench import commands
from bench.errors import BenchmarkError


def main(arguments: Sequence[str]) -> int:
    """Run a command and return its exit status.

    It is 0 on success, 1 if a command that checks something finds it wrong, 2 on a BenchmarkError, and 130 if it is
    interrupted.
    """
    names = command_names()
    if not arguments or arguments[0] in ("-h", "--help"):
        print(_list(names))
        return 0
    if arguments[0] not in names:
        print(f"bench: there is no command {arguments[0]!r}; the commands are {', '.join(names)}.", file=sys.stderr)
        return 2
    return _run(arguments[0], arguments[1:])


def command_names() -> list[str]:
    """Return the names of the commands in alphabetical order."""
    return sorted(module.name for module in iter_modules(commands.__path__))


def _list(names: Sequence[str]) -> str:
    width = max(map(len, names))
    lines = [f"  {name:{width}}  {_summary(name)}" for name in names]
    return "\n".join(["Usage: python -m bench COMMAND [--help]", "", "Commands:", *lines])


def _summary(name: str) -> str:
    """Return the first line of the docstring of a command."""
    return (import_module(f"bench.commands.{name}").__doc__ or "").partition("\n")[0]


def parser_of(name: str) -> argparse.ArgumentParser:
    """Return the parser of the arguments of a command."""
    command = import_module(f"bench.commands.{name}")
    parser = argparse.ArgumentParser(
        prog=f"python -m bench {name}",
        description=command.__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.add_arguments(parser)
    return parser


def _run(name: str, arguments: Sequence[str]) -> int:
    options = parser_of(name).parse_args(arguments)
    try:
        return import_module(f"bench.commands.{name}").run(options) or 0
    except BenchmarkError as error:
        print(f"bench {name}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
