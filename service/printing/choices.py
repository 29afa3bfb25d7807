"""The options of files for printing, for the form of the page."""

from dataclasses import asdict
from typing import Any, get_args

from segcore.printing.options import (
    BED_PATTERN,
    LARGEST_CLEARANCE,
    LARGEST_LENGTH,
    MOST_SLOTS,
    Connectors,
    Place,
    PrintOptions,
    Slicer,
)

_TITLES = {
    "dowel": "Dowels",
    "peg": "Pegs",
    "none": "None",
    "plate": "Side by side",
    "assembled": "Assembled, as in the model",
    "any": "Any: filaments as materials",
    "prusa": "PrusaSlicer: extruders named",
    "bambu": "Bambu Studio, OrcaSlicer: extruders named",
}


def print_choices() -> dict[str, Any]:
    """Return the defaults, the values with titles, and the limits of the options."""
    return {
        "defaults": asdict(PrintOptions()),
        "choices": {
            name: [{"name": value, "title": _TITLES[value]} for value in get_args(kind)]
            for name, kind in (("connectors", Connectors), ("place", Place), ("slicer", Slicer))
        },
        "most": {"clearance": LARGEST_CLEARANCE, "slots": MOST_SLOTS, "size": LARGEST_LENGTH},
        "bedPattern": BED_PATTERN,
    }
