"""Cut a triangle mesh into the parts that a person would name.

Usage::

    import segcore

    mesh = segcore.read_mesh("hand.off")
    hierarchy = segcore.segment(mesh)
    hierarchy.labels(7)
"""

from segcore.errors import CleaveError, InvalidMesh, InvalidParameters, LimitExceeded, UnsupportedFormat
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters
from segcore.warm_up import warm_up

__all__ = [
    "CleaveError",
    "Hierarchy",
    "InvalidMesh",
    "InvalidParameters",
    "LimitExceeded",
    "Mesh",
    "SegmentationParameters",
    "UnsupportedFormat",
    "read_mesh",
    "segment",
    "warm_up",
]
