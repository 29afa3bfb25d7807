"""Read meshes and write segmentations; no other package knows a file format.

Everything that the service, the worker and the command line use is exported here: the formats that can be read
(``FORMATS``, ``read_mesh``, ``ReadLimits``), the files that belong to a mesh file (``neighbours_of``,
``referenced_files``), the formats of segmentations (``WRITERS``, ``writer_for`` and their functions by name), the input
with everything that it has, divided by part (``write_kept``, ``write_kept_parts``), plain
meshes (``write_mesh``), labels and the hierarchy as JSON values, ``.cleave`` files (``write_result``, ``read_result``),
edited parts as bytes (``encode_partition``, ``decode_partition``), pictures (``draw``, ``write_png``) and views from
any side (``view_of``).
"""

from typing import TYPE_CHECKING

from segcore.lazy import lazy_names

if TYPE_CHECKING:
    from segcore.io.converting import with_coordinates
    from segcore.io.edited.partition_file import decode_partition, encode_partition, part_document
    from segcore.io.edited.result_members import Edited, RevisionNote
    from segcore.io.file_sets import is_hidden, is_mesh_name, model_in_folder, name_in_set
    from segcore.io.formats import FORMATS, Format, Layout, PartFormat, PlyColors, declared_format
    from segcore.io.gltf.writer import write_glb
    from segcore.io.keeping import Original, write_kept, write_kept_parts
    from segcore.io.labels import (
        hierarchy_document,
        labels_document,
        runs_document,
        runs_of,
        write_json,
        write_npy,
        write_seg,
    )
    from segcore.io.limits import ReadLimits
    from segcore.io.mesh_writer import write_mesh
    from segcore.io.names import DEFAULT_SEGMENT_NAME, SegmentNames
    from segcore.io.obj.materials_writer import write_mtl, write_obj_archive
    from segcore.io.obj.writer import write_obj
    from segcore.io.palette import SegmentColors, related_colors, segment_color_names
    from segcore.io.parts.writer import write_parts
    from segcore.io.picture import draw, write_png
    from segcore.io.ply.writer import write_ply
    from segcore.io.reading import read_mesh
    from segcore.io.references import neighbours_of, referenced_files
    from segcore.io.result import Segmentation, is_result_file, read_result, write_result
    from segcore.io.threemf.writer import write_3mf
    from segcore.io.view.views import View, view_of
    from segcore.io.writing import WRITE_OPTIONS, WRITERS, WriteOption, Writer, writer_for

_MODULES = {
    "converting": ("with_coordinates",),
    "edited.partition_file": (
        "decode_partition",
        "encode_partition",
        "part_document",
    ),
    "edited.result_members": (
        "Edited",
        "RevisionNote",
    ),
    "file_sets": (
        "is_hidden",
        "is_mesh_name",
        "model_in_folder",
        "name_in_set",
    ),
    "formats": (
        "FORMATS",
        "Format",
        "Layout",
        "PartFormat",
        "PlyColors",
        "declared_format",
    ),
    "gltf.writer": ("write_glb",),
    "keeping": (
        "Original",
        "write_kept",
        "write_kept_parts",
    ),
    "labels": (
        "hierarchy_document",
        "labels_document",
        "runs_document",
        "runs_of",
        "write_json",
        "write_npy",
        "write_seg",
    ),
    "limits": ("ReadLimits",),
    "mesh_writer": ("write_mesh",),
    "names": (
        "DEFAULT_SEGMENT_NAME",
        "SegmentNames",
    ),
    "obj.materials_writer": (
        "write_mtl",
        "write_obj_archive",
    ),
    "obj.writer": ("write_obj",),
    "palette": (
        "SegmentColors",
        "related_colors",
        "segment_color_names",
    ),
    "parts.writer": ("write_parts",),
    "picture": (
        "draw",
        "write_png",
    ),
    "ply.writer": ("write_ply",),
    "reading": ("read_mesh",),
    "references": (
        "neighbours_of",
        "referenced_files",
    ),
    "result": (
        "Segmentation",
        "is_result_file",
        "read_result",
        "write_result",
    ),
    "threemf.writer": ("write_3mf",),
    "view.views": (
        "View",
        "view_of",
    ),
    "writing": (
        "WRITE_OPTIONS",
        "WRITERS",
        "WriteOption",
        "Writer",
        "writer_for",
    ),
}
__getattr__ = lazy_names("segcore.io", _MODULES)

__all__ = [
    "DEFAULT_SEGMENT_NAME",
    "FORMATS",
    "WRITERS",
    "WRITE_OPTIONS",
    "Edited",
    "Format",
    "Layout",
    "Original",
    "PartFormat",
    "PlyColors",
    "ReadLimits",
    "RevisionNote",
    "SegmentColors",
    "SegmentNames",
    "Segmentation",
    "View",
    "WriteOption",
    "Writer",
    "declared_format",
    "decode_partition",
    "draw",
    "encode_partition",
    "hierarchy_document",
    "is_hidden",
    "is_mesh_name",
    "is_result_file",
    "labels_document",
    "model_in_folder",
    "name_in_set",
    "neighbours_of",
    "part_document",
    "read_mesh",
    "read_result",
    "referenced_files",
    "related_colors",
    "runs_document",
    "runs_of",
    "segment_color_names",
    "view_of",
    "with_coordinates",
    "write_3mf",
    "write_glb",
    "write_json",
    "write_kept",
    "write_kept_parts",
    "write_mesh",
    "write_mtl",
    "write_npy",
    "write_obj",
    "write_obj_archive",
    "write_parts",
    "write_ply",
    "write_png",
    "write_result",
    "write_seg",
    "writer_for",
]
