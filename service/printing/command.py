"""The options of `cleave convert --print`, and the file that they ask for."""

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from segcore.errors import InvalidParameters
from segcore.printing.options import CLEARANCE, Connectors, Place, PrintOptions, Slicer
from service.commands.outputs import edited_parts, write_file

if TYPE_CHECKING:
    from segcore.io import Segmentation

_OPTIONS = ("connectors", "clearance", "bed", "slots", "size", "place", "slicer")


def add_print_options(parser: argparse.ArgumentParser) -> None:
    """Add ``--print`` and the options of files for printing, which :func:`print_options` reads."""
    group = parser.add_argument_group("printing")
    group.add_argument(
        "--print",
        action="store_true",
        dest="prints",
        help="write 3MF for printing: solids in mm with connectors and filaments; needs cleave-mesh[print]",
    )
    group.add_argument("--connectors", choices=get_args(Connectors), help="between parts (dowel)")
    group.add_argument(
        "--clearance", type=float, metavar="MM", help=f"diameter of a hole minus that of its dowel or peg ({CLEARANCE})"
    )
    group.add_argument("--bed", metavar="WxDxH", help="divide parts that are larger, such as 250x250x250 (no)")
    group.add_argument("--slots", type=int, metavar="N", help="filaments: join similar colours (one per colour)")
    group.add_argument("--size", type=float, metavar="MM", help="longest side of the whole (that of the mesh)")
    group.add_argument("--place", choices=get_args(Place), help="side by side on the bed, or in place (plate)")
    group.add_argument("--slicer", choices=get_args(Slicer), help="name the extruders for this slicer (any: do not)")
    group.add_argument("--print-report", type=Path, metavar="FILE", help="write the report as JSON")


def print_options(choices: argparse.Namespace) -> PrintOptions | None:
    """Return the options; None if nothing is to be printed.

    Raises
    ------
    InvalidParameters
        If a value is out of range, an option is given without ``--print``, or an output is not 3MF.
    """
    given: dict[str, Any] = {name: getattr(choices, name) for name in _OPTIONS if getattr(choices, name) is not None}
    if not choices.prints:
        if given or choices.print_report:
            raise InvalidParameters(f"--{[*given, 'print-report'][0]} is an option of --print: add --print.")
        return None
    if any(path.suffix.lower() != ".3mf" for path in choices.output):
        raise InvalidParameters("A print is written as 3MF: give an output that ends in .3mf.")
    return PrintOptions(**given)


def write_prints(
    choices: argparse.Namespace, result: "Segmentation", segments: int, options: PrintOptions
) -> list[str]:
    """Write the files and the report of the edited parts, or of a level if there are none; return lines about them.

    Raises
    ------
    CleaveError, OSError
    """
    from segcore.printing.plan import plan_print
    from segcore.printing.report import print_report
    from segcore.printing.writer import write_print

    if result.edited is None:
        plan = plan_print(result.mesh, result.hierarchy, segments, options)
    else:
        hierarchy, looks = edited_parts(result.mesh, result.edited)
        plan = plan_print(result.mesh, hierarchy, None, options, **looks)
    report = print_report(plan)
    for path in choices.output:
        write_file(path, lambda target: write_print(target, plan))
    if choices.print_report is not None:
        document = json.dumps(report, ensure_ascii=False, indent=1).encode()
        write_file(choices.print_report, lambda target: target.write(document))
    return list(_lines(report, has_size=options.size is not None))


def _lines(report: dict[str, Any], *, has_size: bool) -> Iterator[str]:
    if report["unit_of_mesh"] is None and not has_size:
        yield "the unit of the mesh is not known: its lengths are taken as mm (--unit or --size changes that)"
    contacts = report["contacts"]
    joined = sum(contact["connector"] is not None for contact in contacts)
    objects, slots = len(report["objects"]), len(report["slots"])
    yield f"{objects} objects, {slots} filaments, connectors at {joined} of {len(contacts)} contacts"
    if report["connectors"] != "none":
        for contact in contacts:
            if contact["reason"] is not None:
                yield f"parts {contact['parts'][0]} and {contact['parts'][1]}: {contact['reason']}"
    for one in report["objects"]:
        if not one["closed"]:
            yield f"{one['name']} is not a closed solid"
        elif not one["fits_bed"]:
            yield f"{one['name']} is larger than the bed"
