"""The ``.cleave`` file: a mesh and its hierarchy, exact, in one file.

Format, version 1. A ZIP archive whose members are stored without compression, in this order, all dated 1980-01-01, so
that equal results have equal bytes:

    header.json           {"format": "cleave-result", "version": 1, "automatic_segments": int,
                           "limit_reached": bool or null, "unit": str or null, "up": "y", "z" or null,
                           "usual_up": "y" or "z"}
    vertices.npy          (V, 3) float64    faces.npy        (F, 3) int32
    source_polygon.npy    (F,) int32, absent if every polygon of the input is one face
    split_node.npy        (S,) int32        cut_value.npy    (S,) float64
    area.npy              (2 S + 1,) float64
    face_count.npy        (2 S + 1,) int32  face_leaf.npy    (F,) int32
    step.npy              (S,) int32

Then those that the appearance of the mesh has (A rows: one for each vertex, then the further ones):

    normals.npy           (A, 3) float32    uvs.npy          (A, 2) float32
    colors.npy            (A, 4) uint8      corners.npy      (F, 3) int32
    extra_vertex.npy      (A - V,) int32    face_group.npy   (F,) int32
    group_names.json      [str, ...]

Then, if a person has edited the parts:

    edits.json            {"revision": int, "parts": [{"name": str, "color": str or null, "class": str,
                           "locked": bool}, ...],
                           "revisions": [{"number": int, "parent": int, "made_at": str, "made_by": str or null,
                                          "what": str, "parts": int}, ...]}
    edited_labels.npy     (F,) int32, the part of each face, an index of "parts"

The arrays are little-endian, in C order, in NumPy's ``.npy`` format 1.0, and mean what the attributes of the same names
of Mesh, Hierarchy and Appearance mean. A program may ignore unknown members. Nothing in the file is ever unpickled.
Files of earlier versions of Cleave have no ``limit_reached``, ``unit`` and ``up``, which are then not known, and no
``step``: every split is a step.
"""

import json
import os
import zipfile
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from types import NoneType
from typing import Any, BinaryIO, get_args

import numpy as np

from segcore.appearance import Appearance
from segcore.arrays import IntArray
from segcore.coordinates import Axis, Coordinates, Unit
from segcore.errors import InvalidMesh, InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.archive import member, write_array
from segcore.io.edited.members import read_array, read_json
from segcore.io.edited.result_members import Edited, read_edited, write_edited
from segcore.mesh import Mesh
from segcore.nary import numbered_steps

_FORMAT, _VERSION = "cleave-result", 1
_HEADER = "header.json"
_LARGEST_HEADER = 4096  # bytes; the header has about 100
_MESH_ARRAYS = {"vertices": "<f8", "faces": "<i4", "source_polygon": "<i4"}
_TREE_ARRAYS = {
    "split_node": "<i4", "cut_value": "<f8", "area": "<f8", "face_count": "<i4", "face_leaf": "<i4", "step": "<i4",
}  # fmt: skip
_LOOK_ARRAYS = {
    "normals": "<f4", "uvs": "<f4", "colors": "|u1", "corners": "<i4", "extra_vertex": "<i4", "face_group": "<i4",
}  # fmt: skip
_GROUP_NAMES = "group_names.json"
_OPTIONAL = ("source_polygon", "step")


@dataclass(frozen=True, slots=True, eq=False)
class Segmentation:
    """The contents of a ``.cleave`` file."""

    mesh: Mesh
    hierarchy: Hierarchy
    edited: Edited | None = None  # the parts as a person has edited them


def write_result(target: BinaryIO, mesh: Mesh, hierarchy: Hierarchy, edited: Edited | None = None) -> None:
    """Write a mesh and its hierarchy; the same input gives the same bytes.

    Parameters
    ----------
    target : a binary file open for writing.
    edited : parts that a person has edited.

    Raises
    ------
    InvalidParameters
        If the hierarchy is of another mesh.
    """
    if len(hierarchy.face_leaf) != len(mesh.faces) or len(_labels_of(edited, hierarchy)) != len(mesh.faces):
        raise InvalidParameters(
            f"The hierarchy has {len(hierarchy.face_leaf)} faces and the mesh {len(mesh.faces)}: "
            "give the mesh that was segmented."
        )
    header = {
        "format": _FORMAT,
        "version": _VERSION,
        "automatic_segments": hierarchy.automatic_segments,
        "limit_reached": hierarchy.limit_reached,
        **asdict(mesh.coordinates),
    }
    with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(member(_HEADER), json.dumps(header))
        for name, dtype in _MESH_ARRAYS.items():
            if (array := getattr(mesh, name)) is not None:
                write_array(archive, name, array, dtype)
        for name, dtype in _TREE_ARRAYS.items():
            write_array(archive, name, getattr(hierarchy, name), dtype)
        if mesh.appearance is not None:
            _write_appearance(archive, mesh.appearance)
        if edited is not None:
            write_edited(archive, edited)


def read_result(source: str | os.PathLike[str] | BinaryIO) -> Segmentation:
    """Read a ``.cleave`` file.

    Parameters
    ----------
    source : a path, or a seekable binary file.

    Raises
    ------
    InvalidMesh
        If the file has another format or version, is damaged or cut short, or contradicts itself.
    OSError
        If a path cannot be opened.
    """
    if isinstance(source, str | os.PathLike):
        with open(source, "rb") as file:
            return _read(file)
    return _read(source)


def _labels_of(edited: Edited | None, hierarchy: Hierarchy) -> IntArray:
    return hierarchy.face_leaf if edited is None else edited.partition.labels


def _write_appearance(archive: zipfile.ZipFile, look: Appearance) -> None:
    for name, dtype in _LOOK_ARRAYS.items():
        if (array := getattr(look, name)) is not None and len(array):
            write_array(archive, name, array, dtype)
    if look.face_group is not None:
        archive.writestr(member(_GROUP_NAMES), json.dumps(look.group_names))


def _read(file: BinaryIO) -> Segmentation:
    try:
        with zipfile.ZipFile(file) as archive:
            _check_sizes(archive, file.seek(0, os.SEEK_END))
            return _unpack(archive)
    except (zipfile.BadZipFile, NotImplementedError, EOFError, ValueError, RuntimeError) as error:
        raise InvalidMesh("This is not a .cleave file, or it is damaged or cut short: make it again.") from error


def _check_sizes(archive: zipfile.ZipFile, file_size: int) -> None:
    for entry in archive.infolist():
        if entry.compress_type != zipfile.ZIP_STORED or entry.file_size > file_size:
            raise InvalidMesh(
                f"Member {entry.filename!r} of the .cleave file is compressed or cut short: make it again."
            )


def _unpack(archive: zipfile.ZipFile) -> Segmentation:
    header = _read_header(archive)
    present = set(archive.namelist())
    mesh_arrays, tree_arrays = (
        {
            name: read_array(archive, name, dtype)
            for name, dtype in arrays.items()
            if name not in _OPTIONAL or f"{name}.npy" in present
        }
        for arrays in (_MESH_ARRAYS, _TREE_ARRAYS)
    )
    looks = _read_appearance(archive, present)
    mesh = Mesh(
        mesh_arrays["vertices"],
        mesh_arrays["faces"],
        mesh_arrays.get("source_polygon"),
        looks,
        coordinates=_coordinates(header),
    )
    hierarchy = Hierarchy(
        **tree_arrays, automatic_segments=header["automatic_segments"], limit_reached=header.get("limit_reached")
    )
    _check_tree(hierarchy, len(mesh.faces))
    return Segmentation(mesh, hierarchy, read_edited(archive, len(mesh.faces)))


def _read_appearance(archive: zipfile.ZipFile, present: set[str]) -> Appearance | None:
    arrays = {
        name: read_array(archive, name, dtype) for name, dtype in _LOOK_ARRAYS.items() if f"{name}.npy" in present
    }
    if not arrays:
        return None
    names = read_json(archive, _GROUP_NAMES) if "face_group" in arrays else []
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InvalidMesh("The names of groups in the .cleave file are damaged: make the file again.")
    return Appearance(**arrays, group_names=tuple(names))


def _coordinates(header: dict[str, Any]) -> Coordinates:
    values = {field.name: header.get(field.name, field.default) for field in fields(Coordinates)}
    is_known = values["unit"] in (None, *get_args(Unit)) and values["up"] in (None, *get_args(Axis))
    if not is_known or values["usual_up"] not in get_args(Axis):
        raise InvalidMesh("The unit or the axis in the header of the .cleave file is not a known one: make it again.")
    return Coordinates(**values)


def is_result_file(path: Path) -> bool:
    """Whether a path is that of a .cleave file, by its members."""
    if not path.is_file() or not zipfile.is_zipfile(path):
        return False
    with zipfile.ZipFile(path) as archive:
        return _HEADER in archive.namelist()


def _read_header(archive: zipfile.ZipFile) -> dict[str, Any]:
    header = read_json(archive, _HEADER, _LARGEST_HEADER)
    if not isinstance(header, dict) or header.get("format") != _FORMAT:
        raise InvalidMesh("This ZIP archive is not a .cleave file: its header has another format.")
    if header.get("version") != _VERSION:
        raise InvalidMesh(
            f"This .cleave file has version {header.get('version')!r}, and this program reads version {_VERSION}: "
            "read it with the program that wrote it, or make it again."
        )
    if type(header.get("automatic_segments")) is not int:
        raise InvalidMesh("The header of the .cleave file has no automatic_segments: make the file again.")
    if type(header.get("limit_reached")) not in (bool, NoneType):
        raise InvalidMesh("limit_reached in the header of the .cleave file is not true, false or null: make it again.")
    return header


def _check_tree(hierarchy: Hierarchy, face_count: int) -> None:
    """Raise InvalidMesh if the hierarchy is not a binary tree over the faces."""
    splits = len(hierarchy.split_node)
    shapes = {"split_node": splits, "cut_value": splits, "area": 2 * splits + 1, "face_count": 2 * splits + 1}
    for name, length in (shapes | {"face_leaf": face_count, "step": splits}).items():
        if getattr(hierarchy, name).shape != (length,):
            raise InvalidMesh(f"Array {name!r} of the .cleave file does not fit the others: make the file again.")
    numbered = bool((numbered_steps(hierarchy.step) == hierarchy.step).all())
    if not numbered or not _is_tree(hierarchy) or not _counts_agree(hierarchy):
        raise InvalidMesh("The tree of cuts in the .cleave file contradicts itself: make the file again.")


def _is_tree(hierarchy: Hierarchy) -> bool:
    node, leaf = hierarchy.split_node, hierarchy.face_leaf
    earlier = (node >= 0) & (node <= 2 * np.arange(len(node)))
    once = len(np.unique(node)) == len(node)
    if not earlier.all() or not once or not 1 <= hierarchy.automatic_segments <= hierarchy.max_segments:
        return False
    is_leaf = np.ones(hierarchy.node_count, dtype=bool)
    is_leaf[node] = False
    return bool(((leaf >= 0) & (leaf < hierarchy.node_count)).all() and is_leaf[leaf].all())


def _counts_agree(hierarchy: Hierarchy) -> bool:
    counts = np.bincount(hierarchy.face_leaf, minlength=hierarchy.node_count)
    for split in reversed(range(len(hierarchy.split_node))):
        counts[hierarchy.split_node[split]] = counts[2 * split + 1] + counts[2 * split + 2]
    return bool((counts == hierarchy.face_count).all())
