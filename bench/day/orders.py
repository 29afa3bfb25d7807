"""What the clients of the day send: meshes that differ, most of them done at once, some in seconds."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import count

from bench.load.meshes import wavy_torus

_LONG = {"clusters": 20_000, "max_segments": 400}  # with which a mesh of 20,000 faces takes seconds


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """A mesh and the parameters of its segmentation."""

    mesh: bytes  # a PLY file
    parameters: Mapping[str, object] = field(default_factory=dict)

    @property
    def query(self) -> dict[str, str]:
        """The parameters as the API takes them."""
        return {"parameters": json.dumps(dict(self.parameters))} if self.parameters else {}


class Orders:
    """Orders of one client, none of which equals another one of the team.

    Parameters
    ----------
    place : of the client in the team, from 0.
    team : number of clients.
    long_faces : about the number of faces of long orders.
    """

    def __init__(self, place: int, team: int, long_faces: int) -> None:
        self._numbers = count(place, team)
        self._long_faces = long_faces

    def short(self) -> Order:
        return Order(self._mesh(1_000))

    def long(self) -> Order:
        return Order(self._mesh(self._long_faces), _LONG)

    def _mesh(self, faces: int) -> bytes:
        number = next(self._numbers)
        return wavy_torus(faces + 100 * number, 3 + number % 4)
