"""Twenty solids as CAD programs write them: few large flat faces and long thin triangles on round ones."""

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
)
