"""`cleave completion`: print the script with which a shell completes commands, options and file names."""

import argparse

from cleave.settings import InvalidSettings
from cleave.version import extra_command
from service.commands.console import say

SHELLS = ("bash", "zsh")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Print the script with which a shell completes commands, options and file names. In bash, add the line "
        '`eval "$(cleave completion bash)"` to ~/.bashrc; in zsh, write the output to a file _cleave in a folder of '
        "$fpath."
    )
    parser.add_argument("shell", choices=SHELLS)


def run(choices: argparse.Namespace) -> None:
    """Print the script.

    Raises
    ------
    InvalidSettings
        If the optional dependency for it is not installed.
    """
    try:
        import shtab
    except ModuleNotFoundError as error:
        needed = extra_command("completion")
        raise InvalidSettings(f"Completion needs an optional dependency: {needed}.") from error
    from service.commands.main import complete_parser

    parser = complete_parser()
    _mark_files(parser, shtab.FILE)
    say(shtab.complete(parser, choices.shell))


def _mark_files(parser: argparse.ArgumentParser, files: object) -> None:
    """Let the names of files be completed for every argument that is a path."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                _mark_files(command, files)
        elif action.metavar is not None and action.choices is None and _is_path(action):
            action.complete = files  # type: ignore[attr-defined]


def _is_path(action: argparse.Action) -> bool:
    name = str(action.metavar)
    return (name.isupper() and name in ("FILE", "DIR", "MESH")) or "." in name
