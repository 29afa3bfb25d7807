"""WRITERS, the list of every format that a segmented mesh can be written in, by name."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import PurePath
from typing import Literal, TypeAlias

from segcore.errors import UnsupportedFormat
from segcore.lazy import called_later

WriteOption: TypeAlias = Literal[
    "names",
    "part_colors",
    "all_levels",
    "features",
    "layout",
    "keep",
    "capped",
    "part_format",
    "colors",
    "unit",
    "up",
    "edited",
]

# What each option of a writer does, in the order of the command line.
WRITE_OPTIONS: dict[WriteOption, str] = {
    "names": "the name of each segment, by its label",
    "part_colors": "the colour of each segment, by its label",
    "all_levels": "every number of segments in one file",
    "features": "the hierarchy as EXT_structural_metadata, with EXT_mesh_features",
    "layout": "nodes as nested as the hierarchy (tree), or all parts below the root (flat)",
    "keep": "the input with everything that it has, divided by part; as OBJ, the materials and pictures of an OBJ file",
    "capped": "close every part at its cuts, for printing; so by default in 3MF and in parts as STL",
    "part_format": "the files in it",
    "colors": "the colours of segments on vertices, divided between segments, or on faces alone",
    "unit": "the unit of the coordinates, such as mm, if that of the mesh is known",
    "up": "the axis that points up, y or z, if that of the mesh is known",
    "edited": "parts that a person has edited, beside the hierarchy",
}
_MODEL: frozenset[WriteOption] = frozenset({"names"})
_COLORED: frozenset[WriteOption] = _MODEL | {"part_colors"}
# Of formats whose coordinates have no unit and no axis of their own.
_FREE: frozenset[WriteOption] = _MODEL | {"unit", "up"}

# Imported when they are called, as most commands and requests need none of them, or one.
_mtl = called_later("segcore.io.obj.materials_writer:write_mtl")
_seg = called_later("segcore.io.labels:write_seg")
_npy = called_later("segcore.io.labels:write_npy")
_json = called_later("segcore.io.labels:write_json")
_result = called_later("segcore.io.result:write_result")


@dataclass(frozen=True, slots=True)
class Writer:
    """An output format.

    ``write(target, mesh, hierarchy, segments, **options)`` writes the level of ``segments`` segments, or the automatic
    level if it is None, to a binary file from its first byte to its last. It needs only ``write`` and ``flush`` of the
    file. If there is no such level, it raises InvalidParameters before it writes anything. The same input gives the
    same bytes.
    """

    title: str
    extension: str  # with the dot
    media_type: str
    write: Callable[..., tuple[str, ...] | None]  # notes on what could not be kept of the input
    options: frozenset[WriteOption] = frozenset()  # keyword arguments of ``write``; formats of models take ``names``
    companion: str = ""  # the format of a file that belongs beside; ``write`` takes its name as ``library``
    package: str = ""  # the optional package without which ``write`` raises MissingPackage


WRITERS: dict[str, Writer] = {
    "glb": Writer(
        "GLB, a coloured node per segment",
        ".glb",
        "model/gltf-binary",
        called_later("segcore.io.keeping:write_glb_as"),
        _COLORED | {"all_levels", "features", "layout", "keep"},
    ),
    "ply": Writer(
        "PLY, coloured vertices and a label per face",
        ".ply",
        "model/ply",
        called_later("segcore.io.ply.writer:write_ply"),
        _FREE | {"colors", "part_colors"},
    ),
    "obj": Writer(
        "OBJ, an object per segment",
        ".obj",
        "model/obj",
        called_later("segcore.io.obj.writer:write_obj"),
        _FREE,
        companion="mtl",
    ),
    "mtl": Writer(
        "MTL, the colours for the OBJ file",
        ".mtl",
        "model/mtl",
        lambda target, _, hierarchy, segments, **options: _mtl(target, hierarchy, segments, **options),
        _COLORED,
    ),
    "objzip": Writer(
        "OBJ with MTL, an object and a colour per segment as ZIP",
        ".obj.zip",
        "application/zip",
        called_later("segcore.io.keeping:write_obj_archive_as"),
        _FREE | {"keep", "part_colors"},
    ),
    "3mf": Writer(
        "3MF, a closed object per segment",
        ".3mf",
        "model/3mf",
        called_later("segcore.io.threemf.writer:write_3mf"),
        _COLORED | {"capped"},
    ),
    "usdc": Writer(
        "USD, subsets of faces for the parts of every level",
        ".usdc",
        "application/octet-stream",  # no type is registered
        called_later("segcore.io.usd.writer:write_usdc"),
        _COLORED,
        package="usd-core",
    ),
    "usdz": Writer(
        "USDZ, the same as a package",
        ".usdz",
        "model/vnd.usdz+zip",
        called_later("segcore.io.usd.writer:write_usdz"),
        _COLORED,
        package="usd-core",
    ),
    "zip": Writer(
        "ZIP archive, a closed STL file per segment",
        ".zip",
        "application/zip",
        called_later("segcore.io.keeping:write_parts_as"),
        _FREE | {"part_format", "capped", "keep"},
    ),
    "seg": Writer(
        "label of every face, one per line",
        ".seg",
        "text/plain",
        lambda target, _, hierarchy, segments: _seg(target, hierarchy.labels(segments)),
    ),
    "npy": Writer(
        "NumPy array of labels",
        ".npy",
        "application/octet-stream",
        lambda target, _, hierarchy, segments: _npy(target, hierarchy.labels(segments)),
    ),
    "json": Writer(
        "JSON, labels in run-length form and the hierarchy",
        ".json",
        "application/json",
        lambda target, _, hierarchy, segments: _json(target, hierarchy, segments),
    ),
    "cleave": Writer(
        "mesh and hierarchy, to be opened again",
        ".cleave",
        "application/vnd.cleave",
        lambda target, mesh, hierarchy, _, edited=None: _result(target, mesh, hierarchy, edited),
        frozenset({"edited"}),
    ),
}


def writer_for(name: str) -> Writer:
    """Return the writer for a file name, chosen by its extension, the longest one that fits.

    Raises
    ------
    UnsupportedFormat
        If no format has this extension.
    """
    fitting = [writer for writer in WRITERS.values() if PurePath(name).name.lower().endswith(writer.extension)]
    if fitting:
        return max(fitting, key=lambda writer: len(writer.extension))
    known = ", ".join(writer.extension for writer in WRITERS.values())
    raise UnsupportedFormat(f"{name!r} does not end in the extension of an output format: use one of {known}.")
