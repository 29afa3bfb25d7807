"""write_kept: a segmented mesh with everything that the file has that it was read from."""

import os
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, BinaryIO, get_args

import numpy as np

from segcore.errors import InvalidMesh, InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.archive import FAST, member
from segcore.io.formats import PartFormat
from segcore.io.gltf.document import read_document
from segcore.io.gltf.kept.builder import Materials
from segcore.io.gltf.kept.from_mesh import corner_tables, document_of_mesh
from segcore.io.gltf.kept.from_obj import document_of_obj
from segcore.io.gltf.kept.shape import check_members
from segcore.io.gltf.kept.single_parts import SingleParts
from segcore.io.gltf.kept.writer import KeptDocument, write_kept_document
from segcore.io.gltf.writer import write_glb
from segcore.io.limits import ReadLimits
from segcore.io.names import SegmentNames, file_stems, segment_names
from segcore.io.obj.materials import material_files
from segcore.io.obj.materials_writer import write_obj_archive
from segcore.io.obj.writer import FaceMaterials
from segcore.io.palette import SegmentColors
from segcore.io.parts.writer import write_parts
from segcore.io.reading import mesh_of_model, open_model
from segcore.mesh import Mesh
from segcore.structure import NO_ENTRY

_GLB_DEFAULTS: dict[str, object] = {"features": False, "layout": "tree"}  # of write_glb

_NEAR = 1e-4  # of the size of the mesh: vertices of one file that two versions read agree far better


@dataclass(frozen=True, slots=True)
class Original:
    """The file that a mesh was read from; the fields are the arguments of :func:`segcore.io.read_mesh`."""

    source: str | os.PathLike[str] | BinaryIO
    format: str | None = None
    limits: ReadLimits | None = None
    neighbours: bool = False


def write_kept(
    target: BinaryIO,
    original: Original,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    mesh: Mesh | None = None,
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
    all_levels: bool = False,
) -> tuple[str, ...]:
    """Write the file that a mesh was read from as GLB, with its faces divided by part and everything else kept.

    Of glTF these stay as they are: nodes, scenes, materials, textures (the bytes of pictures, which are all inside the
    file), attributes of vertices, skins, animations, morph targets, cameras, lights, extras and unknown extensions.
    Only indices are new. A primitive whose faces are of several parts becomes a list of triangles for each part, in
    their order; one whose faces are of one part is not changed. A mesh that nodes use with different parts is repeated,
    with the same attributes; copies (EXT_mesh_gpu_instancing) with different parts become children of their node. A
    divided primitive is not compressed with Draco.

    An OBJ file becomes glTF with a node for each group and with the materials and pictures of its set; a file of
    another format with its normals, texture coordinates and colours.

    ``extras`` of a primitive has ``part`` (the label) and ``name``; that of the scene has the facts on the hierarchy
    that :func:`segcore.io.write_glb` writes. If they replace something, ``original`` in them has it.

    KHR_materials_variants has the variant ``original look`` and one for each level up to this one, ``k segments``,
    after those of the input; beyond 1,024 levels only for some of them. The materials of the primitives are those of
    the input, so the file looks as it did.

    Parameters
    ----------
    target : a binary file; needs ``write`` only.
    segments : the number of segments K, by default the automatic one.
    mesh : what was segmented; if it is given, the file must have the same faces and vertices.
    names, part_colors : names and colours of segments by label, in place of ``segment k`` and the fixed colours.
    all_levels : divide by the leaves of the hierarchy, with a variant for every level.

    Returns
    -------
    Sentences on what could not be kept, such as a picture that is not among the files.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    InvalidMesh
        If the file is damaged, or not the one that was segmented.
    UnsupportedFormat, LimitExceeded, OSError
        As in :func:`segcore.io.read_mesh`; LimitExceeded also if the output would be larger than 4 GiB.
    """
    limits = original.limits or ReadLimits()
    kept = _kept_document(original, limits, hierarchy, mesh)
    with _flat_enough():
        return write_kept_document(
            target, kept, hierarchy, segments, limits, names=names, part_colors=part_colors, all_levels=all_levels
        )


def write_kept_parts(
    target: BinaryIO,
    original: Original | Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    mesh: Mesh | None = None,
    names: SegmentNames | None = None,
) -> tuple[str, ...]:
    """Write a ZIP archive with a GLB file for each segment: ``segment_0.glb``, ``segment_1.glb``, ...

    A file has the faces of its segment in their places, and what they need of the input: the vertices that they use
    with all attributes and morph targets, materials, pictures with unchanged bytes, the nodes above, skins with their
    joints, and the animations of these nodes. Cameras, lights, material variants, and extensions other than those of
    materials and textures are left out. Only one segment at a time is held in memory.

    Parameters, result and errors are those of :func:`write_kept`; ``original`` may also be a mesh without a file, of
    which the normals, texture coordinates and colours are kept.
    """
    if isinstance(original, Mesh):
        limits, kept = ReadLimits(), document_of_mesh(original, corner_tables(original), Materials())
    else:
        limits = original.limits or ReadLimits()
        kept = _kept_document(original, limits, hierarchy, mesh)
    labels, count = hierarchy.labels(segments), len(hierarchy.segment_nodes(segments))
    stems = file_stems(names, count)
    with _flat_enough(), zipfile.ZipFile(target, "w", compresslevel=FAST) as archive:
        parts = SingleParts.of(kept, labels, segment_names(names, count), limits)
        for part, stem in enumerate(stems):
            with archive.open(member(f"{stem}.glb", compressed=True), "w", force_zip64=True) as file:
                parts.part(part).write(file)
    return parts.notes


def write_parts_as(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    part_format: PartFormat = "stl",
    keep: Original | None = None,
    names: SegmentNames | None = None,
    **options: Any,
) -> tuple[str, ...]:
    """Write a ZIP archive with a file for each segment, by :func:`write_parts`, or :func:`write_kept_parts` as GLB.

    Parameters
    ----------
    keep : the file that the mesh was read from, for parts as GLB; None if only the mesh is there.
    options : those of :func:`write_parts`.

    Raises
    ------
    InvalidParameters
        If an option is given that the format of the parts does not have.
    CleaveError, OSError
        As in these functions.
    """
    if part_format not in get_args(PartFormat):
        raise InvalidParameters(f"Parts are written as {' or '.join(get_args(PartFormat))}, not {part_format!r}.")
    if part_format != "glb":
        if keep is not None:
            raise InvalidParameters(f"Parts as {part_format} do not keep everything of the input: choose glb.")
        write_parts(target, mesh, hierarchy, segments, part_format=part_format, names=names, **options)
        return ()
    given = [name for name, value in options.items() if value]
    if given:
        raise InvalidParameters(f"Parts as glb are as in the input: {', '.join(given)} cannot be chosen.")
    return write_kept_parts(target, keep or mesh, hierarchy, segments, mesh=mesh, names=names)


def write_obj_archive_as(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    keep: Original | None = None,
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
    unit: str | None = None,
    up: str | None = None,
) -> None:
    """Write a ZIP archive with OBJ and MTL, by :func:`write_obj_archive`, or with the materials of an OBJ file.

    With ``keep``, ``model.obj`` has an object for each segment, in which the faces have the materials of the input; its
    MTL files and pictures are beside it, with unchanged bytes.

    Parameters
    ----------
    keep : the OBJ file that the mesh was read from; None for the colours of the segments.

    Raises
    ------
    InvalidParameters
        If the mesh was read from another format.
    CleaveError, OSError
        As of :func:`write_obj_archive` and :func:`write_kept`.
    """
    if keep is None:
        write_obj_archive(target, mesh, hierarchy, segments, names=names, part_colors=part_colors, unit=unit, up=up)
        return
    limits = keep.limits or ReadLimits()
    model = open_model(keep.source, keep.format, limits, neighbours=keep.neighbours)
    if model.format != "obj":
        raise InvalidParameters(
            f"An OBJ file keeps the materials of OBJ files, and this is {model.format}: choose GLB with keep=all."
        )
    original = mesh_of_model(model, limits, appearance=False)
    _check_same(original, hierarchy, mesh)
    structure, files = original.structure, material_files(model.data, model.companions)
    of_face = None if structure is None else structure.material
    materials = FaceMaterials(
        np.full(len(mesh.faces), NO_ENTRY, dtype=np.int32) if of_face is None else of_face,
        () if structure is None else structure.material_names,
        [name for name in files if name.lower().endswith(".mtl")],
    )
    write_obj_archive(
        target, mesh, hierarchy, segments, names=names, unit=unit, up=up, materials=materials, files=files
    )


def write_glb_as(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    keep: Original | None = None,
    all_levels: bool = False,
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
    **options: Any,
) -> tuple[str, ...]:
    """Write a mesh as GLB, by :func:`write_glb`, or :func:`write_kept` if the file that it was read from is given.

    Raises
    ------
    InvalidParameters
        If an option is given that a file that keeps everything of its input does not have.
    CleaveError, OSError
        As in these functions.
    """
    if keep is None:
        options |= {"names": names, "part_colors": part_colors}
        write_glb(target, mesh, hierarchy, segments, all_levels=all_levels, **options)
        return ()
    given = [name for name, value in options.items() if value != _GLB_DEFAULTS.get(name)]
    if given:
        raise InvalidParameters(f"A file that keeps everything of its input has no option {' and '.join(given)}.")
    return write_kept(
        target, keep, hierarchy, segments, mesh=mesh, names=names, part_colors=part_colors, all_levels=all_levels
    )


def _kept_document(
    original: Original, limits: ReadLimits, hierarchy: Hierarchy, segmented: Mesh | None
) -> KeptDocument:
    model = open_model(original.source, original.format, limits, neighbours=original.neighbours)
    mesh = mesh_of_model(model, limits, appearance=model.format not in ("obj", "glb", "gltf"))
    if segmented is not None:
        mesh = replace(mesh, coordinates=segmented.coordinates)
    _check_same(mesh, hierarchy, segmented)
    if model.is_gltf:
        document = read_document(model.data, model.companions)
        check_members(document)
        return KeptDocument(document)
    if model.format == "obj":
        return document_of_obj(model.data, limits, model.companions, mesh.coordinates)
    return document_of_mesh(mesh, corner_tables(mesh), Materials())


def _check_same(mesh: Mesh, hierarchy: Hierarchy, segmented: Mesh | None) -> None:
    """Raise InvalidMesh if a mesh is not the one that was segmented."""
    if len(mesh.faces) != len(hierarchy.face_leaf):
        raise _other_file(f"the file has {len(mesh.faces)} faces, and {len(hierarchy.face_leaf)} were segmented")
    if segmented is not None and not _are_equal(mesh, segmented):
        raise _other_file("its faces are others than those that were segmented")


@contextmanager
def _flat_enough() -> Iterator[None]:
    """Raise InvalidMesh if the members of a document are nested too deeply to be followed."""
    try:
        yield
    except RecursionError as error:
        raise InvalidMesh("The JSON of the glTF file is nested too deeply: export the file again.") from error


def _are_equal(mesh: Mesh, other: Mesh) -> bool:
    if len(mesh.vertices) != len(other.vertices) or not np.array_equal(mesh.faces, other.faces):
        return False
    low, high = other.bounds
    distance = np.abs(mesh.vertices - other.vertices).max(axis=1, where=other.is_used[:, None], initial=0.0)
    return bool(distance.max(initial=0.0) <= _NEAR * (high - low).max())


def _other_file(reason: str) -> InvalidMesh:
    return InvalidMesh(
        f"This is not the file that was segmented, or it was read by an earlier version: {reason}. Segment it again."
    )
