"""Labels and the hierarchy as text, as NumPy arrays and as JSON values."""

import json
import math
from typing import Any, BinaryIO

import numpy as np

from segcore.arrays import IntArray
from segcore.hierarchy import Hierarchy


def write_seg(target: BinaryIO, labels: IntArray) -> None:
    """Write (F,) labels in input face order, one per line: a ``.seg`` file of the Princeton segmentation benchmark."""
    target.write("".join(f"{label}\n" for label in labels.tolist()).encode("ascii"))


def write_npy(target: BinaryIO, labels: IntArray) -> None:
    """Write (F,) labels in input face order as little-endian int32 in NumPy's ``.npy`` format 1.0."""
    np.lib.format.write_array(target, labels.astype("<i4"), version=(1, 0), allow_pickle=False)


def labels_document(hierarchy: Hierarchy, segments: int | None = None) -> dict[str, Any]:
    """Return ``{"segments": K, "labels": [...]}`` with a label 0..K - 1 for each input face, in input order.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    """
    labels = hierarchy.labels(segments)
    return {"segments": hierarchy.automatic_segments if segments is None else segments, "labels": labels.tolist()}


def runs_document(hierarchy: Hierarchy, segments: int | None = None) -> dict[str, Any]:
    """Return ``{"segments": K, "faces": F, "values": [...], "lengths": [...]}``: labels in run-length form.

    The first ``lengths[0]`` faces of the input have the label ``values[0]``, the next ``lengths[1]`` the label
    ``values[1]``, and so on; the lengths add up to F.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    """
    return runs_of(hierarchy.labels(segments), len(hierarchy.segment_nodes(segments)))


def runs_of(labels: IntArray, count: int) -> dict[str, Any]:
    """Return :func:`runs_document` for (F,) labels 0..count - 1."""
    first = np.concatenate([[0], np.flatnonzero(np.diff(labels)) + 1])
    return {
        "segments": count,
        "faces": len(labels),
        "values": labels[first].tolist(),
        "lengths": np.diff(first, append=len(labels)).tolist(),
    }


def write_json(target: BinaryIO, hierarchy: Hierarchy, segments: int | None = None) -> None:
    """Write :func:`runs_document`, with :func:`hierarchy_document` as its ``hierarchy``."""
    document = runs_document(hierarchy, segments) | {"hierarchy": hierarchy_document(hierarchy)}
    target.write(json.dumps(document, allow_nan=False, separators=(",", ":")).encode("ascii"))


def hierarchy_document(hierarchy: Hierarchy) -> dict[str, Any]:
    """Return the hierarchy as JSON values.

    ``cut_values[i]`` is the value of the cut from i + 1 to i + 2 segments and ``steps[i]`` its step; ``step_ends`` are
    the numbers of segments at which no set of equal parts is cut off in part (see :mod:`segcore.nary`).
    ``limit_reached`` says whether the hierarchy ends at a limit that was set (null if that is not known).

    A node has ``id``, ``parent`` (null for the root), ``children`` (empty for a leaf), ``level`` (the smallest number
    of segments at which it is a segment), ``label`` (its label at every level at which it is one), ``area`` (squared
    units of the mesh), ``faces``, ``cut_value`` and ``step`` (of the cut that splits it; null for a leaf) and
    ``nary_children`` (its children in the tree of steps, which starts with the root). A cut value that is not finite is
    null.
    """
    return {
        "max_segments": hierarchy.max_segments,
        "automatic_segments": hierarchy.automatic_segments,
        "limit_reached": hierarchy.limit_reached,
        "steps": hierarchy.step.tolist(),
        "step_ends": hierarchy.step_ends.tolist(),
        "cut_values": [finite_or_none(value) for value in hierarchy.cut_value.tolist()],
        "nodes": node_documents(hierarchy),
    }


def node_documents(hierarchy: Hierarchy) -> list[dict[str, Any]]:
    """Return the ``nodes`` of :func:`hierarchy_document`; entry i is node i."""
    nodes = hierarchy.split_node.tolist()
    cut_value = dict(zip(nodes, hierarchy.cut_value.tolist(), strict=True))
    step = dict(zip(nodes, hierarchy.step.tolist(), strict=True))
    columns = zip(
        hierarchy.parent.tolist(),
        hierarchy.children.tolist(),
        hierarchy.level.tolist(),
        hierarchy.label.tolist(),
        hierarchy.area.tolist(),
        hierarchy.face_count.tolist(),
        hierarchy.nary_children,
        strict=True,
    )
    return [
        {
            "id": node,
            "parent": None if parent < 0 else parent,
            "children": [] if children[0] < 0 else children,
            "level": level,
            "label": label,
            "area": area,
            "faces": faces,
            "cut_value": finite_or_none(cut_value[node]) if node in cut_value else None,
            "step": step.get(node),
            "nary_children": siblings,
        }
        for node, (parent, children, level, label, area, faces, siblings) in enumerate(columns)
    ]


def finite_or_none(value: float) -> float | None:
    """None for infinity, which JSON does not have."""
    return value if math.isfinite(value) else None
