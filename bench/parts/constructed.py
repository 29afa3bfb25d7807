"""Bodies with known copies among their parts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from segcore.arrays import FloatArray, IntArray
    from segcore.mesh import Mesh

Groups = frozenset[frozenset[int]]


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A mesh with labels, and the groups of congruent parts that it was made with."""

    name: str
    mesh: Mesh
    labels: IntArray  # (F,)
    groups: Groups
    mirrored: int  # copies that are mirrored


def cases(fineness: int) -> list[Case]:
    """Return the constructed cases; their numbers of faces grow by about 4 for each step of fineness."""
    rng = np.random.default_rng(0)
    makers: list[Callable[[np.random.Generator, int], Case]] = [_chain, _table, _wheels, _hands, _bolts, _balls]
    return [make(rng, fineness) for make in makers]


def _chain(rng: np.random.Generator, fineness: int) -> Case:
    """Forty links, every second one turned by a quarter, each meshed from another start."""
    count = 12 * 2**fineness
    links = []
    for place in range(40):
        link = _ring(count, count // 2)
        link = link[rng.permutation(len(link))]
        links.append((link[:, :, [0, 2, 1]] if place % 2 else link) + [2.6 * place, 0.0, 0.0])
    return _case("chain of 40 links", links, [range(40)])


def _table(rng: np.random.Generator, fineness: int) -> Case:
    """A top and four legs, of which one is meshed more finely, in any direction in space."""
    top = _refined(_box(4.0, 3.0, 0.2), fineness)
    legs = [_refined(_box(0.3, 0.3, 2.0), fineness + (place == 3)) for place in range(4)]
    feet = [(x, y, -1.2) for x in (-1.7, 1.7) for y in (-1.2, 1.2)]
    turn = _rotation(rng)
    parts = [top, *(leg + foot for leg, foot in zip(legs, feet, strict=True))]
    return _case("table", [part @ turn.T for part in parts], [range(1, 5)])


def _wheels(rng: np.random.Generator, fineness: int) -> Case:
    """Four wheels of 17 teeth in any direction, and one of 18."""
    wheels = [_moved(_refined(_gear(17), fineness - 1), rng) for _ in range(4)]
    return _case("wheels", [*wheels, _moved(_refined(_gear(18), fineness - 1), rng)], [range(4)])


def _hands(rng: np.random.Generator, fineness: int) -> Case:
    """Two right hands and two left ones, which no rotation maps to each other."""
    palm, finger = _box(3.0, 1.0, 1.0), _box(1.0, 2.0, 1.0, (1.0, 1.5, 0.0))
    hand = _refined(np.concatenate([palm, finger, _box(1.0, 1.0, 2.0, (-1.0, 0.0, 1.5))]), fineness)
    left = hand[:, ::-1] * [-1.0, 1.0, 1.0]
    return _case("hands", [_moved(one, rng) for one in (hand, hand, left, left)], [range(4)], mirrored=2)


def _bolts(rng: np.random.Generator, fineness: int) -> Case:
    """Bolts of three lengths, 3 % apart, two of each."""
    lengths = [2.0, 2.06, 2.12] * 2
    bolts = [
        _refined(np.concatenate([_box(1.0, 1.0, 0.5), _box(0.5, 0.5, z, (0.0, 0.0, z / 2))]), fineness) for z in lengths
    ]
    return _case("bolts of 3 lengths", [_moved(bolt, rng) for bolt in bolts], [(0, 3), (1, 4), (2, 5)])


def _balls(rng: np.random.Generator, fineness: int) -> Case:
    """Balls of one size and three finenesses."""
    from segcore.shapes import icosphere

    balls = [_moved(icosphere(fineness + more).corners, rng) for more in (1, 2, 3)]
    return _case("balls", balls, [range(3)])


def _case(name: str, parts: list[FloatArray], groups: Sequence[Sequence[int]], mirrored: int = 0) -> Case:
    """The parts, given as the corners of their faces, as one mesh with welded vertices."""
    from segcore.mesh import Mesh

    corners = np.concatenate(parts)
    labels = np.repeat(np.arange(len(parts), dtype=np.int32), [len(part) for part in parts])
    vertices, which = np.unique(np.round(corners.reshape(-1, 3), 9), axis=0, return_inverse=True)
    mesh = Mesh(vertices, which.reshape(-1, 3))
    return Case(name, mesh, labels, frozenset(frozenset(group) for group in groups), mirrored)


def _moved(corners: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Some faces in any direction, far from others, in any order."""
    moved: FloatArray = corners[rng.permutation(len(corners))] @ _rotation(rng).T + 50.0 * rng.normal(size=3)
    return moved


def _rotation(rng: np.random.Generator) -> FloatArray:
    rotation: FloatArray = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    return rotation


def _refined(corners: FloatArray, times: int) -> FloatArray:
    """Every face cut in four, several times."""
    for _ in range(times):
        a, b, c = corners.transpose(1, 0, 2)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        quarters = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        corners = np.concatenate([np.stack(quarter, axis=1) for quarter in quarters])
    return corners


def _box(x: float, y: float, z: float, centre: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> FloatArray:
    from segcore.shapes import box

    return box((x, y, z), centre).corners


def _ring(along: int, around: int) -> FloatArray:
    """A stretched ring."""
    u, v = np.meshgrid(*(2 * np.pi * np.arange(count) / count for count in (along, around)), indexing="ij")
    radius = 1.0 + 0.25 * np.cos(v)
    points = np.stack([1.6 * radius * np.cos(u), radius * np.sin(u), 0.25 * np.sin(v)], axis=2)
    here, right = points, np.roll(points, -1, axis=0)
    up, both = np.roll(here, -1, axis=1), np.roll(right, -1, axis=1)
    faces = [np.stack(face, axis=2).reshape(-1, 3, 3) for face in ((here, right, both), (here, both, up))]
    return np.concatenate(faces)


def _gear(teeth: int) -> FloatArray:
    """A flat wheel with rectangular teeth."""
    count = 4 * teeth
    angle = 2.0 * np.pi * np.arange(count) / count
    radius = np.where(np.arange(count) // 2 % 2 == 0, 0.9, 1.0)
    low = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(count)], axis=1)
    high = low + np.array([0.0, 0.0, 0.3])
    after, above = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
    bottom, top = np.zeros((count, 3)), np.tile([0.0, 0.0, 0.3], (count, 1))
    rows = [(low, after, above), (low, above, high), (after, low, bottom), (high, above, top)]
    return np.concatenate([np.stack(row, axis=1) for row in rows])
