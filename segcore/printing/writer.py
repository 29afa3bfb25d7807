"""The 3MF file of a print: filaments as base materials, by choice the extruders of a slicer."""

import zipfile
from collections.abc import Iterator, Sequence
from typing import BinaryIO

import numpy as np

from segcore.io.archive import FAST, member
from segcore.io.text.rows import format_rows
from segcore.io.threemf.writer import CORE, MODEL, PACKAGE, TURN, quoted
from segcore.printing.bodies import MATERIALS, Body, bodies_of
from segcore.printing.extruders import HEAD, bambu_settings, prusa_settings
from segcore.printing.plan import Piece, PrintPlan
from segcore.printing.slots import Slot

_TYPES = "[Content_Types].xml"
_CONFIG_TYPE = '<Default Extension="config" ContentType="application/xml"/></Types>'
_SETTINGS = {"prusa": prusa_settings, "bambu": bambu_settings}


def write_print(target: BinaryIO, plan: PrintPlan) -> None:
    """Write a plan as 3MF in millimetres.

    On a plate every piece is an object and an item of its own; the items stand side by side, each on the bed as it is.
    Assembled, there is one item. The material of a piece is the filament of its slot. If a slicer is chosen, a settings
    file names the extruder of every piece: the number of its slot. The file names no program as its maker.

    Parameters
    ----------
    target : a binary file; needs ``write`` only.
    """
    bodies, files = bodies_of(plan), dict(PACKAGE)
    if plan.options.slicer != "any":
        files[_TYPES] = files[_TYPES].replace("</Types>", _CONFIG_TYPE)
        files |= [_SETTINGS[plan.options.slicer](bodies)]
    with zipfile.ZipFile(target, "w", compresslevel=FAST) as archive:
        for name, text in files.items():
            archive.writestr(member(name, compressed=True), text, compresslevel=FAST)
        with archive.open(member(MODEL, compressed=True), "w", force_zip64=True) as model:
            model.writelines(_model(bodies, plan.slots))


def _model(bodies: Sequence[Body], slots: Sequence[Slot]) -> Iterator[bytes]:
    filaments = "".join(f'<base name="filament {one.number}" displaycolor="{one.color.upper()}"/>\n' for one in slots)
    yield (
        f'{HEAD}<model unit="millimeter" xml:lang="en-US" xmlns="{CORE}">\n<resources>\n'
        f'<basematerials id="{MATERIALS}">\n{filaments}</basematerials>\n'
    ).encode()
    for body in bodies:
        if body.is_merged:
            yield from _object(body.number, body.name, body.pieces)
        else:
            for number, piece in zip(body.own, body.pieces, strict=True):
                yield from _object(number, piece.name, [piece])
            components = "".join(f'<component objectid="{number}"/>\n' for number in body.own)
            yield (
                f'<object id="{body.number}" type="model" name={quoted(body.name)}>\n'
                f"<components>\n{components}</components>\n</object>\n"
            ).encode()
    items = "".join(
        f'<item objectid="{body.number}" transform="{TURN} {" ".join(map(repr, body.place.tolist()))}"/>\n'
        for body in bodies
    )
    yield f"</resources>\n<build>\n{items}</build>\n</model>\n".encode("ascii")


def _object(number: int, name: str, pieces: Sequence[Piece]) -> Iterator[bytes]:
    """An object with the meshes of some pieces; triangles name their filament if it is not that of the first piece."""
    usual = pieces[0].slot
    yield (
        f'<object id="{number}" type="model" name={quoted(name)} pid="{MATERIALS}" pindex="{usual - 1}">\n'
        "<mesh>\n<vertices>\n"
    ).encode()
    for piece in pieces:
        yield from format_rows('<vertex x="%r" y="%r" z="%r"/>\n', piece.vertices)
    yield b"</vertices>\n<triangles>\n"
    first = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    for piece, start in zip(pieces, first.tolist(), strict=False):
        filament = "" if piece.slot == usual else f' pid="{MATERIALS}" p1="{piece.slot - 1}"'
        yield from format_rows(f'<triangle v1="%d" v2="%d" v3="%d"{filament}/>\n', piece.faces + start)
    yield b"</triangles>\n</mesh>\n</object>\n"
