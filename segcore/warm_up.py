"""Loading of the compiled kernels before they are needed."""

from segcore.io.limits import ReadLimits
from segcore.io.obj.reader import read_obj
from segcore.io.off.reader import read_off
from segcore.io.picture import draw
from segcore.method import segment
from segcore.shapes import burr, icosphere, joined


def warm_up() -> None:
    """Compile the kernels, or load them from the cache: cut two small shapes, draw one, and read two small files.

    A process that forks workers calls this first: the children then start with everything in memory.
    """
    arms = burr(subdivisions=4).mesh
    draw(arms, segment(arms).labels(), size=16)
    segment(joined(icosphere(1), icosphere(2)).mesh)
    read_obj(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ReadLimits())
    read_off(b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", ReadLimits())
