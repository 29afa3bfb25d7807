"""Forty solids as CAD programs write them: few large flat faces and long thin triangles on round ones."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from bench.errors import BenchmarkError
from segcore.errors import MissingPackage
from segcore.mesh import Mesh
from segcore.printing.booleans import library

if TYPE_CHECKING:
    from manifold3d import Manifold

Point = tuple[float, float, float]
_AROUND = 64  # edges of a circle


def cad_meshes() -> dict[str, Mesh]:
    """Return the solids by name.

    Raises
    ------
    BenchmarkError
        If manifold3d is not installed.
    """
    try:
        return {make.__name__.removeprefix("_"): _mesh(make()) for make in _SOLIDS}
    except MissingPackage as error:
        raise BenchmarkError(str(error)) from error


def _mesh(solid: Manifold) -> Mesh:
    mesh = solid.to_mesh()
    return Mesh(np.asarray(mesh.vert_properties[:, :3], dtype=np.float64), np.asarray(mesh.tri_verts, dtype=np.int32))


def _box(size: Point, centre: Point = (0.0, 0.0, 0.0)) -> Manifold:
    return library().Manifold.cube(size, center=True).translate(centre)


def _rod(radius: float, height: float, centre: Point = (0.0, 0.0, 0.0), turn: Point = (0.0, 0.0, 0.0)) -> Manifold:
    """A cylinder along z, turned by angles in degrees and moved."""
    rod = library().Manifold.cylinder(height, radius, radius, _AROUND, center=True)
    return rod.rotate(turn).translate(centre)


def _around(part: Manifold, count: int) -> Manifold:
    """Copies of a part around z."""
    return library().Manifold.compose([part.rotate((0.0, 0.0, 360.0 * i / count)) for i in range(count)])


def _union(*parts: Manifold) -> Manifold:
    return library().Manifold.batch_boolean(list(parts), library().OpType.Add)


def _plate() -> Manifold:
    holes = _union(*[_rod(0.12, 1, (x, y, 0)) for x in (-0.8, 0.8) for y in (-0.5, 0.5)])
    return _box((2, 1.4, 0.15)) - holes - _rod(0.35, 1)


def _angle() -> Manifold:
    holes = _union(*[_rod(0.08, 1, (0.6, y, 0)) for y in (-0.3, 0.3)])
    return _union(_box((1.2, 1, 0.12), (0.6, 0, 0)), _box((0.12, 1, 1.2), (0, 0, 0.54))) - holes


def _beam() -> Manifold:
    flanges = _union(_box((0.8, 3, 0.1), (0, 0, 0.45)), _box((0.8, 3, 0.1), (0, 0, -0.45)))
    return _union(flanges, _box((0.1, 3, 1)))


def _flange() -> Manifold:
    disc = _rod(1, 0.2) - _around(_rod(0.08, 1, (0.75, 0, 0)), 8)
    return _union(disc, _rod(0.45, 1.4, (0, 0, 0.6))) - _rod(0.35, 4)


def _pipe() -> Manifold:
    ends = _union(_rod(0.7, 0.15, (0, 0, 1.2)), _rod(0.7, 0.15, (0, 0, -1.2)))
    return _union(_rod(0.4, 2.4), ends) - _rod(0.3, 4) - _around(_rod(0.06, 4, (0.55, 0, 0)), 6)


def _shaft() -> Manifold:
    return _union(_rod(0.2, 3), _rod(0.35, 1, (0, 0, -0.3)), _rod(0.6, 0.2, (0, 0, 0.6)))


def _gear() -> Manifold:
    teeth = _around(_box((0.36, 0.2, 0.34), (1.08, 0, 0)), 16)
    return _union(_rod(1, 0.4), teeth, _rod(0.35, 0.9)) - _rod(0.2, 2)


def _pulley() -> Manifold:
    return _union(_rod(1, 0.1, (0, 0, 0.2)), _rod(1, 0.1, (0, 0, -0.2)), _rod(0.8, 0.5), _rod(0.3, 0.9)) - _rod(0.15, 2)


def _wheel() -> Manifold:
    rim = _rod(1, 0.3) - _rod(0.85, 1)
    return _union(rim, _around(_box((0.8, 0.12, 0.12), (0.5, 0, 0)), 5), _rod(0.25, 0.4)) - _rod(0.12, 2)


def _link() -> Manifold:
    ends = _union(_rod(0.5, 0.3, (-1.2, 0, 0)), _rod(0.3, 0.3, (1.2, 0, 0)))
    return _union(ends, _box((2.4, 0.25, 0.15))) - _rod(0.35, 1, (-1.2, 0, 0)) - _rod(0.18, 1, (1.2, 0, 0))


def _fork() -> Manifold:
    arms = _union(*[_box((1.2, 0.2, 0.6), (0.8, y, 0)) for y in (-0.4, 0.4)])
    return _union(_box((0.5, 1, 0.6)), arms, _rod(0.2, 1.2, (-0.8, 0, 0), (0, 90, 0))) - _rod(
        0.12, 3, (1.1, 0, 0), (90, 0, 0)
    )


def _clevis() -> Manifold:
    sides = _union(*[_box((0.1, 1, 1.2), (x, 0, 0.6)) for x in (-0.6, 0.6)])
    return _union(_box((1.3, 1, 0.1)), sides) - _rod(0.2, 4, (0, 0, 0.8), (0, 90, 0))


def _enclosure() -> Manifold:
    tray = _box((2, 1.4, 0.6)) - _box((1.8, 1.2, 0.6), (0, 0, 0.1))
    places = [(x, y, -0.05) for x in (-0.78, 0.78) for y in (-0.48, 0.48)]
    posts = _union(*[_rod(0.1, 0.4, place) - _rod(0.04, 1, place) for place in places])
    return _union(tray, posts)


def _table() -> Manifold:
    return _union(_box((2, 1.2, 0.1)), *[_rod(0.07, 1, (x, y, -0.5)) for x in (-0.85, 0.85) for y in (-0.45, 0.45)])


def _knob() -> Manifold:
    return _union(_rod(0.8, 0.4), _box((0.15, 1.4, 0.3), (0, 0, 0.3)), _rod(0.2, 0.8, (0, 0, -0.5)))


def _bolt() -> Manifold:
    return _union(library().Manifold.cylinder(0.4, 0.55, 0.55, 6, center=True), _rod(0.3, 2, (0, 0, -1.1)))


def _lever() -> Manifold:
    ball = library().Manifold.sphere(0.28, _AROUND).translate((0, 0, 1.6))
    return _union(_rod(0.6, 0.2, (0, 0, -0.1)), _rod(0.1, 1.6, (0, 0, 0.8)), ball)


def _block() -> Manifold:
    pillow = _union(
        _box((2.2, 0.6, 0.25)), _rod(0.55, 0.6, (0, 0, 0.5), (90, 0, 0)), _box((1.1, 0.6, 0.6), (0, 0, 0.25))
    )
    return pillow - _rod(0.3, 1, (0, 0, 0.5), (90, 0, 0)) - _union(*[_rod(0.1, 1, (x, 0, 0)) for x in (-0.85, 0.85)])


def _heat_sink() -> Manifold:
    return _union(_box((1.6, 1.4, 0.15)), *[_box((0.06, 1.4, 0.8), (x, 0, 0.4)) for x in np.linspace(-0.7, 0.7, 8)])


def _elbow() -> Manifold:
    pipes = _union(
        _rod(0.4, 1.4, (0, 0, 0.7)), _rod(0.4, 1.4, (0.7, 0, 0), (0, 90, 0)), _rod(0.4, 0.8, (0, 0, 0), (90, 0, 0))
    )
    collars = _union(_rod(0.6, 0.15, (0, 0, 1.4)), _rod(0.6, 0.15, (1.4, 0, 0), (0, 90, 0)))
    return _union(pipes, collars)


def _nut() -> Manifold:
    return library().Manifold.cylinder(0.4, 0.6, 0.6, 6, center=True) - _rod(0.35, 2)


def _washer() -> Manifold:
    return _rod(1, 0.1) - _rod(0.5, 1)


def _screw() -> Manifold:
    socket = library().Manifold.cylinder(0.3, 0.25, 0.25, 6).translate((0, 0, 0.25))
    return _union(_rod(0.5, 0.5, (0, 0, 0.25)), _rod(0.3, 2, (0, 0, -1))) - socket


def _key_shaft() -> Manifold:
    return _union(_rod(0.3, 3), _rod(0.5, 0.6)) - _box((0.12, 0.2, 0.8), (0.3, 0, 1.1))


def _bosses() -> Manifold:
    places = [(x, y, 0.25) for x in (-0.6, 0.6) for y in (-0.6, 0.6)]
    return _union(_box((2, 2, 0.2)), *[_rod(0.25, 0.5, place) for place in places]) - _union(
        *[_rod(0.12, 3, place) for place in places]
    )


def _fillet() -> Manifold:
    """An angle with a round inner edge."""
    turn = np.linspace(0.0, np.pi / 2, 13)
    inner = np.stack([0.4 - 0.3 * np.sin(turn), 0.4 - 0.3 * np.cos(turn)], axis=1)
    outline = np.concatenate([[(0, 0), (1.2, 0), (1.2, 0.1)], inner, [(0.1, 1.2), (0, 1.2)]])
    return library().Manifold.extrude(library().CrossSection([outline]), 1)


def _bottle() -> Manifold:
    along = np.linspace(0.0, 1.0, 20)
    shoulder = np.stack([0.5 - 0.175 * (1.0 - np.cos(np.pi * along)), 1.2 + 0.4 * along], axis=1)
    neck = [(0.15, 1.6), (0.15, 2.0), (0.2, 2.0), (0.2, 2.15), (0, 2.15)]
    outline = np.concatenate([[(0, 0), (0.5, 0), (0.5, 1.2)], shoulder, neck])
    return library().Manifold.revolve(library().CrossSection([outline]), _AROUND)


def _mug() -> Manifold:
    ring = library().CrossSection.circle(0.07, 24).translate((0.32, 0))
    handle = library().Manifold.revolve(ring, 48).rotate((90, 0, 0)).translate((0.55, 0, 0))
    return _union(_rod(0.5, 1) - _rod(0.43, 1, (0, 0, 0.08)), handle - _rod(0.47, 2))


def _ribs() -> Manifold:
    across = [_box((0.08, 1, 0.4), (x, 0, 0.2)) for x in (-0.8, -0.4, 0.0, 0.4, 0.8)]
    return _union(_box((2, 1, 0.1)), *across, _box((2, 0.08, 0.4), (0, 0, 0.2)))


def _fan() -> Manifold:
    blade = _box((0.8, 0.04, 0.5)).rotate((35, 0, 0)).translate((0.75, 0, 0))
    return _union(_rod(0.4, 0.6), _around(blade, 9))


def _hinge() -> Manifold:
    heights = (-0.8, 0.0, 0.8)
    knuckles = [_rod(0.15, 0.4, (0, 0, z)) for z in heights] + [_box((0.8, 0.08, 0.4), (0.45, 0, z)) for z in heights]
    holes = [_rod(0.06, 1, (0.7, 0, z), (90, 0, 0)) for z in (-0.9, 0.0, 0.9)]
    return _union(*knuckles, _box((0.6, 0.08, 2.4), (0.7, 0, 0))) - _union(_rod(0.07, 4), *holes)


def _stairs() -> Manifold:
    steps = [point for i in range(6) for point in ((0.3 * i, 0.3 * (i + 1)), (0.3 * (i + 1), 0.3 * (i + 1)))]
    outline = np.array([(0, 0), *steps, (1.8, 0)])[::-1]
    return library().Manifold.extrude(library().CrossSection([outline]), 1)


def _branch() -> Manifold:
    """A pipe with another one at its side."""
    pipes = _union(_rod(0.4, 2.4), _rod(0.3, 1.4, (0.7, 0, 0), (0, 90, 0)))
    return pipes - _rod(0.33, 3) - _rod(0.23, 2, (1, 0, 0), (0, 90, 0))


def _window() -> Manifold:
    panes = [_box((0.8, 1, 0.6), (x, 0, z)) for x in (-0.45, 0.45) for z in (-0.37, 0.37)]
    return _box((2, 0.15, 1.6)) - _union(*panes)


def _comb() -> Manifold:
    teeth = [_box((0.06, 0.1, 0.8), (x, 0, -0.5)) for x in np.linspace(-0.9, 0.9, 12)]
    return _union(_box((2, 0.1, 0.4)), *teeth)


def _beads() -> Manifold:
    discs = [_rod(0.2, 0.1, (0.5 * i, 0, 0)) for i in range(6)]
    return _union(*discs, *[_box((0.5, 0.1, 0.06), (0.5 * i + 0.25, 0, 0)) for i in range(5)])


def _tower() -> Manifold:
    tiers = [_box((1.2, 1.2, 0.3)), _box((0.8, 0.8, 0.8), (0, 0, 0.5)), _box((0.5, 0.5, 1), (0, 0, 1.3))]
    return _union(*tiers, _rod(0.12, 1, (0, 0, 2.2)))


def _crank() -> Manifold:
    arms = [_box((0.3, 1, 0.2), (0, 0.4, z)) for z in (0.0, 0.8)]
    return _union(*arms, _rod(0.2, 0.8, (0, 0, -0.5)), _rod(0.18, 0.7, (0, 0.8, 0.4)), _rod(0.2, 0.8, (0, 0, 1.3)))


def _spool() -> Manifold:
    discs = [_rod(1, 0.1, (0, 0, z)) for z in (-0.5, 0.5)]
    return _union(*discs, _rod(0.4, 1)) - _rod(0.2, 3) - _around(_rod(0.15, 3, (0.7, 0, 0)), 5)


def _gearbox() -> Manifold:
    shaft = _union(_rod(0.3, 0.4, (0.95, 0, 0), (0, 90, 0)), _rod(0.15, 1, (1.3, 0, 0), (0, 90, 0)))
    lugs = [_box((0.3, 0.3, 0.1), (x, y, -0.45)) for x in (-0.9, 0.9) for y in (-0.4, 0.4)]
    holes = [_rod(0.07, 2, (x, y, 0)) for x in (-0.95, 0.95) for y in (-0.4, 0.4)]
    return _union(_box((1.6, 1, 1)), shaft, *lugs) - _union(*holes)


_SOLIDS: tuple[Callable[[], Manifold], ...] = (
    _plate,
    _angle,
    _beam,
    _flange,
    _pipe,
    _shaft,
    _gear,
    _pulley,
    _wheel,
    _link,
    _fork,
    _clevis,
    _enclosure,
    _table,
    _knob,
    _bolt,
    _lever,
    _block,
    _heat_sink,
    _elbow,
    _nut,
    _washer,
    _screw,
    _key_shaft,
    _bosses,
    _fillet,
    _bottle,
    _mug,
    _ribs,
    _fan,
    _hinge,
    _stairs,
    _branch,
    _window,
    _comb,
    _beads,
    _tower,
    _crank,
    _spool,
    _gearbox,
)
