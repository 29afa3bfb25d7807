"""Meshes in, segmentations out: the only code that knows file formats."""

from segcore.io.formats import FORMATS, Format
from segcore.io.limits import ReadLimits
from segcore.io.reading import read_mesh

__all__ = ["FORMATS", "Format", "ReadLimits", "read_mesh"]
