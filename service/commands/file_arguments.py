"""The arguments of the commands that work on files alone: `cleave convert` and `cleave inspect`."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction[Any]

OUTPUTS = ".glb .ply .obj .3mf .zip .seg .npy .json .cleave"

# Each command imports what it needs when it runs, as in service.commands.


def add_fineness(parser: argparse.ArgumentParser, automatic: str) -> None:
    """The arguments that say how fine the segments are; ``automatic`` says what is done without."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--segments", type=int, metavar="K", help=f"number of segments ({automatic})")
    group.add_argument(
        "--granularity",
        type=_granularity,
        metavar="G",
        help="in place of a number: 0 coarse (one segment), 0.5 automatic, 1 fine (all there are)",
    )


def add_outputs(parser: argparse.ArgumentParser, required: bool = False) -> None:
    """The arguments that :func:`service.commands.outputs.output_options` reads, and ``output``."""
    parser.add_argument(
        "-o",
        "--output",
        type=_output,
        action="append",
        required=required,
        default=None if required else [],
        metavar="FILE",
        help=f"what to write, by its extension: {OUTPUTS}; may be given again",
    )
    parser.add_argument("--all-levels", action="store_true", help="GLB: every number of segments in one file")
    parser.add_argument(
        "--features", action="store_true", help="GLB: the hierarchy as EXT_structural_metadata, with EXT_mesh_features"
    )
    parser.add_argument("--capped", action="store_true", help="3MF and ZIP: close every part, for printing")
    parser.add_argument("--parts", choices=("stl", "obj"), default="stl", help="ZIP: the files in it (%(default)s)")


def add_convert(commands: "Commands", say: Callable[[str], None]) -> None:
    convert = commands.add_parser(
        "convert",
        help="write a .cleave file in other formats",
        description="Write the segmentation that a .cleave file holds in other formats, at any number of segments.",
    )
    convert.add_argument("result", type=Path, metavar="MESH.cleave", help="what cleave segment --result wrote")
    add_fineness(convert, "the automatic one")
    add_outputs(convert, required=True)
    convert.set_defaults(run=lambda choices: _convert(choices, say))


def add_inspect(commands: "Commands", say: Callable[[str], None]) -> None:
    inspect = commands.add_parser(
        "inspect",
        help="say what is in a mesh file",
        description="Say what is in a mesh file: components, borders, and whatever a segmentation has to put right.",
    )
    inspect.add_argument("mesh", type=Path, metavar="MESH", help="the mesh file")
    inspect.add_argument("--json", action="store_true", help="as JSON")
    inspect.set_defaults(run=lambda choices: _inspect(choices, say))


def _convert(choices: argparse.Namespace, say: Callable[[str], None]) -> None:
    from segcore.levels import Fineness
    from service.commands.convert import convert_file
    from service.commands.outputs import output_options

    fineness = Fineness(choices.segments, choices.granularity)
    written = convert_file(choices.result, fineness, choices.output, output_options(choices))
    say("\n".join(written))


def _inspect(choices: argparse.Namespace, say: Callable[[str], None]) -> None:
    from service.commands.inspect import describe, inspect_file, report_json

    report = inspect_file(choices.mesh)
    say(report_json(report) if choices.json else "\n".join(describe(choices.mesh.name, report)))


def _granularity(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = -1.0
    if not 0.0 <= number <= 1.0:
        raise argparse.ArgumentTypeError(f"a granularity is a number from 0 (coarse) to 1 (fine), not {text!r}")
    return number


def _output(text: str) -> Path:
    if Path(text).suffix.lower() not in OUTPUTS.split():
        raise argparse.ArgumentTypeError(f"{text!r} must end in one of {OUTPUTS}")
    return Path(text)
