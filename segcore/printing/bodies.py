"""Bodies: what stands on the bed by itself, one piece on a plate, or all pieces together."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray
from segcore.printing.plan import Piece, PrintPlan
from segcore.printing.plate import places_on_plate

MATERIALS = 1  # the id of the filaments in the 3MF file; those of objects follow
_ASSEMBLY = "assembly"


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """An item of the 3MF file with its pieces."""

    number: int  # the id of its object
    name: str
    pieces: Sequence[Piece]
    own: Sequence[int]  # the ids of the objects of the pieces: that of the body, or of its components
    is_merged: bool  # all pieces are one mesh
    place: FloatArray  # (3,) what is added to its vertices

    @property
    def ranges(self) -> list[tuple[int, int]]:
        """The first and the last triangle of each piece in the mesh of a merged body."""
        ends = np.cumsum([len(piece.faces) for piece in self.pieces]).tolist()
        return list(zip([0, *ends[:-1]], [end - 1 for end in ends], strict=True))


def bodies_of(plan: PrintPlan) -> list[Body]:
    """Return the bodies of a plan.

    Slicers drop every body on the bed, so that pieces that stay in place are one body: its components, or for
    PrusaSlicer, which reads components as bodies, one mesh.
    """
    first = MATERIALS + 1
    own = [first + k for k in range(len(plan.pieces))]
    if plan.options.place == "plate":
        boxes = [np.stack([piece.vertices.min(axis=0), piece.vertices.max(axis=0)]) for piece in plan.pieces]
        places = places_on_plate(boxes, plan.options.sides[0])
        return [
            Body(number, piece.name, [piece], [number], True, place)
            for number, piece, place in zip(own, plan.pieces, places, strict=True)
        ]
    if plan.options.slicer == "prusa":
        return [Body(first, _ASSEMBLY, plan.pieces, [first], True, np.zeros(3))]
    return [Body(first + len(own), _ASSEMBLY, plan.pieces, own, False, np.zeros(3))]
