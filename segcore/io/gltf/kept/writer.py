"""Writes a glTF document with its primitives divided by part and everything else as it was."""

from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from segcore.arrays import IntArray
from segcore.hierarchy import Hierarchy
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.document import Document, integer
from segcore.io.gltf.kept.asset import KeptAsset
from segcore.io.gltf.kept.division import divide
from segcore.io.gltf.kept.marks import Marks, add_variants, with_extras
from segcore.io.gltf.triangles import scene_parts
from segcore.io.gltf.writer_scene import (
    Drawing,
    all_levels_drawing,
    level_drawing,
    level_materials,
    scene_facts,
    variant_names,
)
from segcore.io.limits import ReadLimits
from segcore.io.names import SegmentNames, segment_names
from segcore.io.palette import SegmentColors

_MOST_LEVELS = 1024  # every part lists all of them; a hierarchy has as many by itself


@dataclass(frozen=True, slots=True, eq=False)
class KeptDocument:
    """A document, and the face of the mesh that was segmented for each triangle of its scene."""

    document: Document
    face: IntArray | None = None  # (F,); None if triangle i is face i
    notes: tuple[str, ...] = ()  # on what could not be kept


def write_kept_document(
    target: BinaryIO,
    kept: KeptDocument,
    hierarchy: Hierarchy,
    segments: int | None,
    limits: ReadLimits,
    *,
    names: SegmentNames | None,
    part_colors: SegmentColors | None,
    all_levels: bool,
) -> tuple[str, ...]:
    """Write a document as GLB; see :func:`segcore.io.keeping.write_kept`. Return notes on what could not be kept.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    InvalidMesh, UnsupportedFormat, LimitExceeded
    """
    drawing = (all_levels_drawing if all_levels else level_drawing)(hierarchy, segments)
    levels = _levels(len(drawing.nodes))
    asset = KeptAsset.of(kept.document)
    materials = level_materials(hierarchy, drawing.nodes, levels)
    marks = add_variants(asset, segment_names(names, len(drawing.nodes)), materials, variant_names(levels), part_colors)
    divide_document(asset, kept, drawing.of_face, marks, limits)
    _describe(asset, kept.document, hierarchy, drawing)
    asset.write(target)
    return (*kept.notes, *asset.notes)


def _levels(count: int) -> list[int]:
    """The numbers of segments that are variants: all up to ``count``, or some of them, ever farther apart."""
    if count <= _MOST_LEVELS:
        return list(range(1, count + 1))
    return sorted({round(level) for level in np.geomspace(1, count, _MOST_LEVELS).tolist()})


def divide_document(
    asset: KeptAsset,
    kept: KeptDocument,
    part_of_face: IntArray,
    marks: Marks,
    limits: ReadLimits,
    *,
    is_plain: bool = False,
) -> dict[int, list[int | None]]:
    """Divide the primitives of a copy of a document; see :func:`segcore.io.gltf.kept.division.divide`.

    Parameters
    ----------
    part_of_face : (F,) the part of each face of the mesh that was segmented.
    """
    accessors = Accessors(kept.document, limits)
    found = scene_parts(kept.document, accessors, limits)
    parts = part_of_face if kept.face is None else part_of_face[kept.face]
    return divide(asset, kept.document, accessors, found, parts, marks, is_plain=is_plain)


def _describe(asset: KeptAsset, document: Document, hierarchy: Hierarchy, drawing: Drawing) -> None:
    """Add the facts on the hierarchy to the extras of the default scene, or of the file if it has no scene."""
    facts = scene_facts(hierarchy, drawing)
    if not document.count("scenes"):
        asset.root = with_extras(asset.root, facts)
        return
    scene = integer(document.root, "scene", "the top level", 0)
    asset.root["scenes"][scene] = with_extras(asset.root["scenes"][scene], facts)
