"""Outputs that keep everything of the file that a mesh was read from: write_kept, and a file for each part."""

import os
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from segcore.errors import InvalidMesh
from segcore.hierarchy import Hierarchy
from segcore.io.gltf.document import read_document
from segcore.io.gltf.kept.writer import KeptDocument, write_kept_document
from segcore.io.limits import ReadLimits
from segcore.io.names import SegmentNames
from segcore.io.reading import OpenedModel, mesh_of_model, open_model
from segcore.mesh import Mesh
