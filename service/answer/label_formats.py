"""The formats of labels, selected by ?format= or Accept (RFC 9110, section 12.5.1), and the hierarchy as JSON."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, BinaryIO, Literal

from segcore.io import WRITERS, Segmentation, hierarchy_document, labels_document, runs_document
from service.answer.level import ChosenCut
from service.answer.renditions import Rendition, to_bytes
from service.problems import Problem

LabelsFormat = Literal["json", "runs", "seg", "npy", "raw"]


@dataclass(frozen=True, slots=True)
class LabelsEncoding:
    """One format of labels."""

    title: str
    media_type: str
    extension: str
    encode: Callable[[ChosenCut], bytes]
    is_binary: bool = False  # browsers save it instead of showing it


def compact_json(document: dict[str, Any]) -> bytes:
    """Return a document as JSON without spaces."""
    return json.dumps(document, allow_nan=False, separators=(",", ":")).encode()


def hierarchy_json(result: Segmentation) -> bytes:
    """Return the hierarchy of a result and the curve that helps to choose a number of segments, as JSON."""
    document = hierarchy_document(result.hierarchy)
    nodes = result.hierarchy.split_node.tolist()
    curve = [
        {"segments": split + 2, "cut_value": value, "node": node, "step": step}
        for split, (value, node, step) in enumerate(zip(document["cut_values"], nodes, document["steps"], strict=True))
    ]
    return compact_json(document | {"curve": curve})


def _write_with(name: str) -> Callable[[ChosenCut], bytes]:
    """Return a function that encodes labels with a writer of segcore."""

    def write(cut: ChosenCut, target: BinaryIO) -> None:
        WRITERS[name].write(target, cut.result.mesh, cut.result.hierarchy, cut.segments)

    return lambda cut: to_bytes(partial(write, cut))


# The first one is the default of a client that accepts any.
LABELS: dict[LabelsFormat, LabelsEncoding] = {
    "json": LabelsEncoding(
        "JSON",
        "application/json",
        ".json",
        lambda cut: compact_json(labels_document(cut.result.hierarchy, cut.segments)),
    ),
    "runs": LabelsEncoding(
        "JSON, runs of equal labels",
        "application/vnd.cleave.runs+json",
        ".json",
        lambda cut: compact_json(runs_document(cut.result.hierarchy, cut.segments)),
    ),
    "seg": LabelsEncoding(
        "text, one label per line", "text/plain; charset=utf-8", WRITERS["seg"].extension, _write_with("seg")
    ),
    "npy": LabelsEncoding(
        "NumPy array of int32", "application/x-npy", WRITERS["npy"].extension, _write_with("npy"), is_binary=True
    ),
    "raw": LabelsEncoding(
        "little-endian int32",
        "application/octet-stream",
        ".bin",
        lambda cut: cut.result.hierarchy.labels(cut.segments).astype("<i4").tobytes(),
        is_binary=True,
    ),
}


def labels_rendition(cut: ChosenCut, format: LabelsFormat | None, accept: str) -> Rendition:  # noqa: A002
    """Return the labels at a level, in the given format or in the one that an Accept header prefers.

    Raises
    ------
    Problem
        If the header accepts no format.
    """
    name = format or negotiate(accept)
    encoding = LABELS[name]
    return Rendition(
        identity=f"{cut.job_id}/labels?{cut.name}&format={name}",
        media_type=encoding.media_type,
        render=lambda: encoding.encode(cut),
        file_name=f"{cut.job_id}{encoding.extension}" if encoding.is_binary else None,
        vary=None if format else "Accept",
    )


def negotiate(accept: str) -> LabelsFormat:
    """Return the format of labels that an Accept header prefers.

    Raises
    ------
    Problem
        If it accepts none.
    """
    ranges = _media_ranges(accept or "*/*")
    media_types = {name: encoding.media_type.partition(";")[0] for name, encoding in LABELS.items()}
    quality = {name: _quality(media_type, ranges) for name, media_type in media_types.items()}
    best = max(quality, key=lambda name: quality[name])  # the first of equals
    if quality[best] == 0:
        known = ", ".join(media_types.values())
        raise Problem("not_acceptable", f"Labels are available as {known}: accept one of these, or use ?format=.")
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
    """Return the weight of the most specific range that contains a media type, 0 if there is none."""
    for candidate in (media_type, f"{media_type.partition('/')[0]}/*", "*/*"):
        if candidate in ranges:
            return ranges[candidate]
    return 0.0
