"""WRITERS: every file that a segmented mesh can be written as, by name."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import PurePath
from typing import BinaryIO, TypeAlias

from segcore.errors import UnsupportedFormat
from segcore.hierarchy import Hierarchy
from segcore.io.gltf.writer import write_glb
from segcore.io.labels import write_json, write_npy, write_seg
from segcore.io.obj.writer import write_obj
from segcore.io.parts.writer import write_parts
from segcore.io.ply.writer import write_ply
from segcore.io.result import write_result
from segcore.io.threemf.writer import write_3mf
from segcore.mesh import Mesh

Write: TypeAlias = Callable[[BinaryIO, Mesh, Hierarchy, int | None], None]


@dataclass(frozen=True, slots=True)
class Writer:
    """One kind of output.

    ``write(target, mesh, hierarchy, segments)`` writes the level of ``segments`` segments, by default (None) the
    automatic one, to a binary file that needs ``write`` and ``flush`` only, from its first byte to its last; it raises
    InvalidParameters, before anything is written, where there is no such level. The same input gives the same bytes.
    The functions that some of them are (write_glb, write_3mf, write_parts) have more options under their own names.
    """

    title: str
    extension: str  # with the dot
    media_type: str
    write: Write


WRITERS: dict[str, Writer] = {
    "glb": Writer("GLB, a coloured node per segment", ".glb", "model/gltf-binary", write_glb),
    "ply": Writer("PLY, a colour and a label per face", ".ply", "model/ply", write_ply),
    "obj": Writer("OBJ, a group per segment", ".obj", "model/obj", write_obj),
    "3mf": Writer("3MF, an object per segment", ".3mf", "model/3mf", write_3mf),
    "zip": Writer("ZIP archive, an STL file per segment", ".zip", "application/zip", write_parts),
    "seg": Writer(
        "label of every face, one per line",
        ".seg",
        "text/plain",
        lambda target, _, hierarchy, segments: write_seg(target, hierarchy.labels(segments)),
    ),
    "npy": Writer(
        "NumPy array of labels",
        ".npy",
        "application/octet-stream",
        lambda target, _, hierarchy, segments: write_npy(target, hierarchy.labels(segments)),
    ),
    "json": Writer(
        "JSON, labels in run-length form and the hierarchy",
        ".json",
        "application/json",
        lambda target, _, hierarchy, segments: write_json(target, hierarchy, segments),
    ),
    "cleave": Writer(
        "mesh and hierarchy, to be opened again",
        ".cleave",
        "application/vnd.cleave",
        lambda target, mesh, hierarchy, _: write_result(target, mesh, hierarchy),
    ),
}


def writer_for(name: str) -> Writer:
    """The writer for the name of a file, by its extension.

    Raises
    ------
    UnsupportedFormat
        Where there is none.
    """
    extension = PurePath(name).suffix.lower()
    for writer in WRITERS.values():
        if writer.extension == extension:
            return writer
    known = ", ".join(writer.extension for writer in WRITERS.values())
    raise UnsupportedFormat(f"{name!r} names no format that is written here: end it in one of {known}.")
