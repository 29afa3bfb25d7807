"""Times from dropping a mesh on the page to its picture, in headless Chromium, whose graphics the processor draws.

Starts `cleave serve` of this version, and of the one --from, and drops the same meshes on both pages in turn. The
time contains the upload and the job. The first picture may have fewer faces than the mesh.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
from contextlib import ExitStack
from pathlib import Path

from bench.checkout import HERE, version
from bench.load.installation import installed
from bench.load.meshes import wavy_torus
from bench.text import format_table, number
from bench.viewer.browser import chromium
from bench.viewer.drop import Drop, dropped

_FACES = (20_000, 300_000, 1_060_000)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--from", dest="previous", metavar="VERSION", help="a commit, or the folder of a checkout, to compare with"
    )
    parser.add_argument("--faces", type=int, nargs="*", default=_FACES, metavar="N", help="faces of each mesh")
    parser.add_argument("--repetitions", type=int, default=3, metavar="N", help="drops of each mesh (%(default)s)")
    parser.add_argument("--chromium", type=Path, default=Path("/usr/bin/chromium"), help="the browser to use")


def run(arguments: argparse.Namespace) -> None:
    with ExitStack() as stack:
        versions = {"this": HERE}
        if arguments.previous:
            versions[arguments.previous] = stack.enter_context(version(arguments.previous))
        urls = {name: stack.enter_context(installed(1, version=root)).url for name, root in versions.items()}
        browser = stack.enter_context(chromium(arguments.chromium))
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        rows = []
        for wanted in arguments.faces:
            drops: dict[str, list[Drop]] = {name: [] for name in urls}
            for repetition in range(arguments.repetitions):
                mesh = folder / f"{wanted}-{repetition}.ply"
                faces = _write(mesh, wanted, repetition)
                for name, url in urls.items():
                    drops[name].append(dropped(browser, url, mesh, faces))
            rows += [_row(name, found) for name, found in drops.items()]
    print(format_table(["faces", "version", "job, ms", "first picture, ms", "full picture, ms"], rows))


def _write(path: Path, faces: int, repetition: int) -> int:
    """Write a mesh that the service does not know; return its number of faces."""
    content = wavy_torus(faces, 3 + repetition)
    path.write_bytes(content)
    return int(content[: content.index(b"end_header")].partition(b"element face ")[2].split()[0])


def _row(name: str, drops: list[Drop]) -> list[str]:
    times = ([drop.job_ms for drop in drops], [drop.picture_ms for drop in drops], [drop.full_ms for drop in drops])
    return [f"{drops[0].faces:,}", name, *(number(statistics.median(one), 0) for one in times)]
