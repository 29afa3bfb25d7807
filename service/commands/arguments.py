"""Arguments that several commands share. The arguments for output files are in :mod:`service.commands.outputs`."""

import argparse
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, get_args

from segcore.coordinates import Axis, Unit, unit_named
from segcore.errors import InvalidParameters
from segcore.parameters import Structure

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo


def add_level(parser: argparse.ArgumentParser, default: str) -> None:
    """Add ``--segments`` and ``--granularity``; ``default`` describes the number of segments if neither is given."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--segments", type=int, metavar="K", help=f"number of segments ({default})")
    group.add_argument(
        "--granularity",
        type=_granularity,
        metavar="G",
        help="instead of a number: 0 coarse (one segment), 0.5 automatic, 1 fine (as many as possible)",
    )


def add_parameters(parser: argparse.ArgumentParser, example: str) -> None:
    """Add ``--set``, which collects pairs of a name and a value in ``parameters``."""
    parser.add_argument(
        "--set",
        type=_parameter,
        action="append",
        default=[],
        dest="parameters",
        metavar="NAME=VALUE",
        help=f"a parameter of the method, such as {example}; can be repeated",
    )


def add_structure(parser: argparse.ArgumentParser) -> None:
    """Add ``--structure``, the parameter of that name."""
    parser.add_argument(
        "--structure",
        choices=get_args(Structure),
        help="what of the file the first levels follow: its connected components, its nodes and groups, or its "
        "materials (none)",
    )


def add_coordinates(parser: argparse.ArgumentParser) -> None:
    """Add ``--unit`` and ``--up``, the meaning of the coordinates of a mesh file."""
    parser.add_argument(
        "--unit", type=_unit, metavar="UNIT", help="unit of the coordinates, such as mm, if the file does not name it"
    )
    parser.add_argument("--up", choices=get_args(Axis), help="axis that points up, if the file does not name it")


def _unit(text: str) -> Unit:
    try:
        return unit_named(text)
    except InvalidParameters as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def add_data_dir(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data-dir", type=Path, metavar="DIR", help="the data folder, instead of CLEAVE_DATA_DIR")


def add_workers(parser: argparse.ArgumentParser, least: int) -> None:
    """Add ``--workers``, which must be at least ``least``."""
    parser.add_argument(
        "--workers",
        type=_at_least(least),
        metavar="N",
        help="jobs at a time (one less than cores, but at least one small and one large job)",
    )


def add_settings_help(parser: argparse.ArgumentParser) -> None:
    """List the settings below the arguments in the help of a command."""
    from cleave.settings import Settings

    rows = [
        (f"CLEAVE_{name.upper()}", f"{field.description} Default: {_default_of(field)}.")
        for name, field in Settings.model_fields.items()
    ]
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.epilog = "settings from the environment:\n" + "\n".join(f"  {name:<27} {text}" for name, text in rows)


def _default_of(field: "FieldInfo") -> str:
    if field.default_factory is not None:
        return "a folder of the user"
    if field.default in (None, ""):
        return "none"
    return f"{field.default:g}" if isinstance(field.default, float) else str(field.default).lower()


def port(text: str) -> int:
    """The type of an argument that is a TCP port."""
    number = int(text)
    if not 0 <= number <= 65535:
        raise argparse.ArgumentTypeError("a port is a number from 0 to 65535")
    return number


def _granularity(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = -1.0
    if not 0.0 <= number <= 1.0:
        raise argparse.ArgumentTypeError(f"a granularity is a number from 0 (coarse) to 1 (fine), not {text!r}")
    return number


def _parameter(text: str) -> tuple[str, object]:
    """Split NAME=VALUE; the value is converted to a number if possible."""
    name, equals, value = text.partition("=")
    if not name or not equals:
        raise argparse.ArgumentTypeError(f"a parameter is NAME=VALUE, not {text!r}")
    for number in (int, float):
        with suppress(ValueError):
            return name, number(value)
    return name, value


def _at_least(least: int) -> Callable[[str], int]:
    def number(text: str) -> int:
        value = int(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"must be at least {least}")
        return value

    return number
