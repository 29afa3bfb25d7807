"""The mesh file that a command reads: its arguments, and the standard input in its place."""

import argparse
import io
import sys
from pathlib import Path
from typing import BinaryIO

import segcore
from service.commands.arguments import add_coordinates

STANDARD = Path("-")  # the standard input or output


def add_mesh(parser: argparse.ArgumentParser) -> None:
    """Add the mesh file, ``--unit`` and ``--up``, which :func:`read_input` reads."""
    parser.add_argument(
        "mesh",
        type=Path,
        metavar="MESH",
        help="the mesh file, or a folder or ZIP archive with one; - for the standard input",
    )
    add_coordinates(parser)


def read_input(choices: argparse.Namespace) -> segcore.Mesh:
    """Read the mesh file of a command; errors as of :func:`segcore.read_mesh`."""
    source = standard_input(choices.mesh)
    return segcore.read_mesh(source, appearance=True, neighbours=True, unit=choices.unit, up=choices.up)


def input_name(path: Path) -> str:
    """Return the name of the file to read, for messages."""
    return "standard input" if path == STANDARD else path.name


def standard_input(path: Path) -> Path | BinaryIO:
    """Return the file to read: the whole standard input for -, else the path."""
    return io.BytesIO(sys.stdin.buffer.read()) if path == STANDARD else path
