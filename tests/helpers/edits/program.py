"""The process of edits with the stand-in for a Guide."""

import os
import time

from helpers.edits.guide import MarksOnly
from segcore.arrays import BoolArray, IntArray
from segcore.edit.tools import PartFinder
from segcore.io import Segmentation
from service.edit.program import main

SLOW, DEADLY, LARGE = 7, 8, 9  # a mark of this face alone


class Moody(MarksOnly):
    def part(self, inside: IntArray, outside: IntArray) -> BoolArray:
        if inside.tolist() == [SLOW]:
            time.sleep(60)
        if inside.tolist() == [DEADLY]:
            os._exit(3)
        if inside.tolist() == [LARGE]:
            raise MemoryError
        return super().part(inside, outside)


def moody(result: Segmentation) -> PartFinder:
    return Moody(len(result.mesh.faces))


if __name__ == "__main__":
    main(moody)
