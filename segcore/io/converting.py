"""A mesh with its coordinates in another unit, or with another axis up."""

from dataclasses import replace

import numpy as np

from segcore.arrays import transformed
from segcore.coordinates import Axis, Coordinates, Unit, axis_named, unit_named
from segcore.errors import InvalidParameters
from segcore.mesh import Mesh


def with_coordinates(mesh: Mesh, unit: str | None = None, up: str | None = None) -> Mesh:
    """Return the mesh with a unit and an axis that somebody has said; the coordinates do not change.

    They count more than those of the file. If they contradict it, the notes say so.

    Raises
    ------
    InvalidParameters
        If there is no such unit or axis.
    """
    of_file = mesh.coordinates
    said = Coordinates(
        of_file.unit if unit is None else unit_named(unit),
        of_file.up if up is None else axis_named(up),
        of_file.usual_up,
    )
    if said == of_file:
        return mesh
    notes = [
        f"The {what} is {now}, as was said, and not {before} as the file has it."
        for what, now, before in (("unit", said.unit, of_file.unit), ("axis that points up", said.up, of_file.up))
        if before not in (None, now)
    ]
    return replace(mesh, coordinates=said, notes=(*mesh.notes, *notes))


def converted(mesh: Mesh, unit: Unit | None = None, up: Axis | None = None) -> Mesh:
    """Return the mesh in another unit and with another axis up, as far as those of the mesh are known.

    Parameters
    ----------
    unit, up : those of the result; None keeps the ones of the mesh.
    """
    known = mesh.coordinates
    scale = known.scale_to(unit) if unit else 1.0
    turn = known.rotation_to(up) if up else np.eye(3)
    if scale == 1.0 and (turn == np.eye(3)).all():
        return mesh
    look = mesh.appearance
    if look is not None and look.normals is not None:
        look = replace(look, normals=transformed(look.normals.astype(np.float64), turn).astype(np.float32))
    new = Coordinates(unit if unit and known.unit else known.unit, up if up and known.up else known.up, known.usual_up)
    return replace(mesh, vertices=transformed(mesh.vertices * scale, turn), appearance=look, coordinates=new)


def requested(mesh: Mesh, unit: str | None, up: str | None) -> Mesh:
    """Return the mesh in the unit and with the axis up that a caller has chosen for a file.

    Raises
    ------
    InvalidParameters
        If there is no such unit or axis, or that of the mesh is not known.
    """
    known = mesh.coordinates
    if unit is not None and known.unit is None:
        raise InvalidParameters(
            f"The mesh cannot be converted to {unit_named(unit)}, because its own unit is not known: say it when the "
            "mesh is read."
        )
    if up is not None and known.up is None:
        raise InvalidParameters(
            f"The mesh cannot be turned to {axis_named(up)} up, because it is not known which axis points up: say it "
            "when the mesh is read."
        )
    return converted(mesh, None if unit is None else unit_named(unit), None if up is None else axis_named(up))
