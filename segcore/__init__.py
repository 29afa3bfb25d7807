"""Cut a triangle mesh into the parts that a person would name.

Usage::

    import segcore

    mesh = segcore.read_mesh("hand.off")
    hierarchy = segcore.segment(mesh)
    hierarchy.labels(7)

Public are the names of this package:

- ``read_mesh``, ``Mesh``: the input
- ``segment``, ``SegmentationParameters``, ``parameters_schema``, ``warm_up``: the method and its choices
- ``Partition``, ``Part``, ``partition_of``: any labels of the faces, with names, colours and classes of the parts
- ``parts``, ``PartList``, ``MeasuredPart``: what can be measured of the parts, and which are copies of each other
- ``Hierarchy``, ``Fineness``, ``keep_splits``: the result at any number of segments
- ``Guide``: corrections by hand, the part around marked faces and borders between parts
- ``mesh_report``, ``MeshReport``, ``build_surface``, ``Surface``: the cleaned mesh and the defects that were found
- the modules of ``segcore.printing`` and ``segcore.robots``: ``options``, ``plan``, ``report`` and ``writer``, files
  for printing and for simulators
- ``CleaveError``, ``InvalidMesh``, ``UnsupportedFormat``, ``InvalidParameters``, ``PartLocked``,
  ``MissingPackage``, ``LimitExceeded``: the errors

and the modules that define them, ``segcore.io`` (readers and writers), ``segcore.edit.operations`` and
``segcore.edit.tools``, ``segcore.part_list``, ``segcore.appearance``, ``segcore.structure``, ``segcore.progress`` and
``segcore.shapes`` (procedural meshes). The packages of the stages (``clean``, ``affinity``, ``coarsen``, ``symmetry``,
``cut``, ``label``), the rest of ``edit``, and ``solvers``, ``graphs`` and ``learned`` are internal, except for
``Surface``, ``build_surface`` and ``Guide``.
"""

from typing import TYPE_CHECKING

import segcore.jit.cache  # noqa: F401  # before any kernel
from segcore.lazy import lazy_names

if TYPE_CHECKING:
    from segcore.clean.surface import Surface, build_surface
    from segcore.edit.guide import Guide
    from segcore.errors import (
        CleaveError,
        InvalidMesh,
        InvalidParameters,
        LimitExceeded,
        MissingPackage,
        PartLocked,
        UnsupportedFormat,
    )
    from segcore.hierarchy import Hierarchy
    from segcore.io import read_mesh
    from segcore.kernels.tasks import warm_up
    from segcore.levels import Fineness, keep_splits
    from segcore.mesh import Mesh
    from segcore.method import segment
    from segcore.parameters import SegmentationParameters, parameters_schema
    from segcore.part_list.listing import MeasuredPart, PartList, parts
    from segcore.partition import Part, Partition, partition_of
    from segcore.report import MeshReport, mesh_report

# Imported when a name is first used, as a process that reads a result, for example, needs no kernel.
_MODULES = {
    "clean.surface": ("Surface", "build_surface"),
    "edit.guide": ("Guide",),
    "errors": (
        "CleaveError",
        "InvalidMesh",
        "InvalidParameters",
        "LimitExceeded",
        "MissingPackage",
        "PartLocked",
        "UnsupportedFormat",
    ),
    "hierarchy": ("Hierarchy",),
    "io": ("read_mesh",),
    "levels": ("Fineness", "keep_splits"),
    "mesh": ("Mesh",),
    "method": ("segment",),
    "parameters": ("SegmentationParameters", "parameters_schema"),
    "part_list.listing": ("MeasuredPart", "PartList", "parts"),
    "partition": ("Part", "Partition", "partition_of"),
    "report": ("MeshReport", "mesh_report"),
    "kernels.tasks": ("warm_up",),
}
__getattr__ = lazy_names("segcore", _MODULES)

__all__ = [
    "CleaveError",
    "Fineness",
    "Guide",
    "Hierarchy",
    "InvalidMesh",
    "InvalidParameters",
    "LimitExceeded",
    "MeasuredPart",
    "Mesh",
    "MeshReport",
    "MissingPackage",
    "Part",
    "PartList",
    "PartLocked",
    "Partition",
    "SegmentationParameters",
    "Surface",
    "UnsupportedFormat",
    "build_surface",
    "keep_splits",
    "mesh_report",
    "parameters_schema",
    "partition_of",
    "parts",
    "read_mesh",
    "segment",
    "warm_up",
]
