"""Loading of the compiled kernels before they are needed."""

from segcore.segment import segment
from segcore.shapes import burr, icosphere, joined


def warm_up() -> None:
    """Compile the kernels, or load them from the cache, by cutting two small shapes.

    A process that forks workers calls this first: the children then start with everything in memory.
    """
    segment(burr(subdivisions=4).mesh)
    segment(joined(icosphere(1), icosphere(2)).mesh)
