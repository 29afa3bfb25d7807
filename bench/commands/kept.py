"""Outputs that keep everything of glTF files, against the files: bytes of pictures, pixels, animations, validator.

Every file is divided into five bands across its longest side, and drawn with three.js in headless Chromium as it was
and as the output. Translucent surfaces and faces at the same place may differ, because parts are drawn one by one.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from bench.errors import BenchmarkError
from bench.kept.check import Comparison, compare
from bench.kept.three_page import ThreePage
from bench.text import format_table
from bench.viewer.browser import chromium

_THREE = Path("viewer/node_modules/three")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE", help="GLB and glTF files")
    parser.add_argument("--three", type=Path, default=_THREE, metavar="DIR", help="the npm package three (%(default)s)")
    parser.add_argument("--validator", type=Path, metavar="DIR", help="the npm package gltf-validator (no validation)")
    parser.add_argument("--chromium", type=Path, default=Path("/usr/bin/chromium"), help="the browser to use")


def run(arguments: argparse.Namespace) -> None:
    from segcore.errors import CleaveError

    found: list[Comparison] = []
    refused: list[str] = []
    with chromium(arguments.chromium) as browser:
        page = ThreePage(browser, arguments.three)
        for path in arguments.files:
            print(path.name, file=sys.stderr)
            try:
                found.append(compare(path, page, arguments.validator))
            except (CleaveError, BenchmarkError) as error:
                refused.append(f"{path.name}: {error}")
    print(render(found, refused))


def render(found: list[Comparison], refused: list[str]) -> str:
    """Return the comparisons as text, a line for each file and a summary."""
    rows = [
        [
            one.file,
            f"{one.faces:,}",
            f"{one.bytes_after / one.bytes_before:.2f}",
            f"{one.pictures - one.lost_pictures}/{one.pictures}",
            " ".join(one.new_errors) or "0",
            str(one.differing_pixels),
            f"{one.largest_move:.1g}",
        ]
        for one in found
    ]
    header = ["file", "faces", "size", "pictures kept", "new errors", "pixels that differ", "move"]
    same = sum(one.differing_pixels == 0 for one in found)
    moving = sum(one.largest_move == 0 for one in found)
    summary = (
        f"{len(found)} files: {same} look the same in every pixel, {moving} move as before, "
        f"{sum(one.lost_pictures for one in found)} pictures lost, "
        f"{sum(bool(one.new_errors) for one in found)} with new errors of the validator."
    )
    return "\n".join([format_table(header, rows), "", summary, *refused])
