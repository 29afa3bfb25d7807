"""Labels in the form that a client asks for: by ?format=, otherwise by Accept (RFC 9110, section 12.5.1)."""

import io
import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from segcore.hierarchy import Hierarchy
from segcore.io.labels import labels_document, runs_document, write_npy, write_seg
from service.problems import Problem

LabelsFormat = Literal["json", "runs", "seg", "npy", "raw"]


@dataclass(frozen=True, slots=True)
class LabelsForm:
    title: str
    media_type: str
    extension: str
    render: Callable[[Hierarchy, int], bytes]


def compact_json(document: dict[str, Any]) -> bytes:
    return json.dumps(document, allow_nan=False, separators=(",", ":")).encode()


def _seg(hierarchy: Hierarchy, segments: int) -> bytes:
    target = io.BytesIO()
    write_seg(target, hierarchy.labels(segments))
    return target.getvalue()


def _npy(hierarchy: Hierarchy, segments: int) -> bytes:
    target = io.BytesIO()
    write_npy(target, hierarchy.labels(segments))
    return target.getvalue()


# The first is what a client gets that accepts anything.
LABELS: dict[LabelsFormat, LabelsForm] = {
    "json": LabelsForm(
        "JSON", "application/json", ".json", lambda tree, segments: compact_json(labels_document(tree, segments))
    ),
    "runs": LabelsForm(
        "JSON, runs of equal labels",
        "application/vnd.cleave.runs+json",
        ".json",
        lambda tree, segments: compact_json(runs_document(tree, segments)),
    ),
    "seg": LabelsForm("text, one label per line", "text/plain; charset=utf-8", ".seg", _seg),
    "npy": LabelsForm("NumPy array of int32", "application/x-npy", ".npy", _npy),
    "raw": LabelsForm(
        "little-endian int32",
        "application/octet-stream",
        ".bin",
        lambda tree, segments: tree.labels(segments).astype("<i4").tobytes(),
    ),
}


def negotiate(accept: str) -> LabelsFormat:
    """The form of the labels that an Accept header likes best.

    Raises
    ------
    Problem
        Where it likes none.
    """
    ranges = _media_ranges(accept or "*/*")
    quality = {name: _quality(form.media_type.partition(";")[0], ranges) for name, form in LABELS.items()}
    best = max(quality, key=lambda name: quality[name])  # the first of equals
    if quality[best] == 0:
        known = ", ".join(form.media_type.partition(";")[0] for form in LABELS.values())
        raise Problem("not_acceptable", f"Labels are sent as {known}: accept one of these, or ask with ?format=.")
    return best


def _media_ranges(accept: str) -> dict[str, float]:
    ranges: dict[str, float] = {}
    for part in accept.split(","):
        name, *parameters = (piece.strip().lower() for piece in part.split(";"))
        weights = [parameter[2:] for parameter in parameters if parameter.startswith("q=")]
        try:
            ranges[name] = min(max(float(weights[0]), 0.0), 1.0) if weights else 1.0
        except ValueError:
            ranges[name] = 0.0
    return ranges


def _quality(media_type: str, ranges: dict[str, float]) -> float:
    """The weight of the most specific range that a media type is in."""
    for candidate in (media_type, f"{media_type.partition('/')[0]}/*", "*/*"):
        if candidate in ranges:
            return ranges[candidate]
    return 0.0
