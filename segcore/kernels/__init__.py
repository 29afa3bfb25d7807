"""Compilation of the kernels before they are used: once for all processes, in parallel.

``manifest.json`` lists the kernels that are called from Python, with the types of their arguments, in groups by what
needs them. ``compile_kernels`` compiles groups of them into numba's cache. After a change of kernels, write the list
again with ``python -m segcore.kernels.recording``; ``python -m segcore.kernels`` compiles all of them.
"""

from segcore.kernels.compilation import compile_kernels, must_compile
from segcore.kernels.manifest import FIRST, GROUPS, READ, SEGMENT
from segcore.kernels.place import CompilationProgress
from segcore.kernels.processes import environment

__all__ = [
    "FIRST",
    "GROUPS",
    "READ",
    "SEGMENT",
    "CompilationProgress",
    "compile_kernels",
    "environment",
    "must_compile",
]
