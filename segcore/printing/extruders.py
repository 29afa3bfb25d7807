"""The settings file that tells a slicer the extruder of every piece; the core of 3MF has materials only."""

from collections.abc import Sequence

from segcore.io.threemf.writer import quoted
from segcore.printing.bodies import Body
from segcore.printing.plan import Piece

HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'


def prusa_settings(bodies: Sequence[Body]) -> tuple[str, str]:
    """Return the name and the text of the file that PrusaSlicer reads: volumes as ranges of triangles."""
    objects = "".join(
        f'<object id="{body.number}" instances_count="1">\n'
        f'<metadata type="object" key="name" value={quoted(body.name)}/>\n'
        f"{''.join(map(_prusa_volume, body.pieces, body.ranges))}</object>\n"
        for body in bodies
    )
    return "Metadata/Slic3r_PE_model.config", f"{HEAD}<config>\n{objects}</config>\n"


def _prusa_volume(piece: Piece, triangles: tuple[int, int]) -> str:
    values = {"name": quoted(piece.name), "volume_type": '"ModelPart"', "extruder": f'"{piece.slot}"'}
    lines = "".join(f'<metadata type="volume" key="{key}" value={value}/>\n' for key, value in values.items())
    return f'<volume firstid="{triangles[0]}" lastid="{triangles[1]}">\n{lines}</volume>\n'


def bambu_settings(bodies: Sequence[Body]) -> tuple[str, str]:
    """Return the name and the text of the file that Bambu Studio and OrcaSlicer read: parts by the ids of objects."""
    objects = "".join(
        f'<object id="{body.number}">\n<metadata key="name" value={quoted(body.name)}/>\n'
        f'<metadata key="extruder" value="{body.pieces[0].slot}"/>\n'
        f"{''.join(map(_bambu_part, body.pieces, body.own))}</object>\n"
        for body in bodies
    )
    return "Metadata/model_settings.config", f"{HEAD}<config>\n{objects}</config>\n"


def _bambu_part(piece: Piece, number: int) -> str:
    return (
        f'<part id="{number}" subtype="normal_part">\n<metadata key="name" value={quoted(piece.name)}/>\n'
        f'<metadata key="extruder" value="{piece.slot}"/>\n</part>\n'
    )
