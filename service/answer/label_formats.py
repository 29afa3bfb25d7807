"""The formats of labels, selected by ?format= or Accept (RFC 9110, section 12.5.1), and the hierarchy as JSON."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from pydantic_core import to_json

from segcore.arrays import IntArray
from segcore.errors import InvalidParameters
from segcore.io import WRITERS, Segmentation, hierarchy_document, part_document, runs_of, write_npy, write_seg
from service.answer.level import ChosenCut
from service.answer.renditions import Rendition, to_bytes
from service.problems import Problem

LabelsFormat = Literal["json", "runs", "seg", "npy", "raw"]
LabelsOf = Literal["part", "class"]


@dataclass(frozen=True, slots=True)
class LabelsEncoding:
    """One format of labels."""

    title: str
    media_type: str
    extension: str
    encode: Callable[["ShownLabels"], bytes]
    is_binary: bool = False  # browsers save it instead of showing it


def compact_json(document: dict[str, Any]) -> bytes:
    """Return a document as JSON without spaces."""
    return json.dumps(document, allow_nan=False, separators=(",", ":")).encode()


def with_members(body: bytes, others: bytes) -> bytes:
    """Return a JSON object with the members of two; neither may be empty."""
    return body[:-1] + b"," + others[1:]


def labels_json(labels: dict[str, Any]) -> bytes:
    """Return a document as of :func:`segcore.io.labels_document` as JSON, in a quarter of the time of other ones."""
    return to_json(labels)


def hierarchy_json(result: Segmentation) -> bytes:
    """Return the hierarchy of a result and the curve that helps to choose a number of segments, as JSON."""
    document = hierarchy_document(result.hierarchy)
    nodes = result.hierarchy.split_node.tolist()
    curve = [
        {"segments": split + 2, "cut_value": value, "node": node, "step": step}
        for split, (value, node, step) in enumerate(zip(document["cut_values"], nodes, document["steps"], strict=True))
    ]
    return compact_json(document | {"curve": curve})


@dataclass(frozen=True, slots=True, eq=False)
class ShownLabels:
    """The numbers of the faces that a response has, of parts or of their classes."""

    numbers: IntArray  # (F,)
    count: int  # the numbers are 0..count - 1
    said: dict[str, Any]  # further members of JSON documents

    @classmethod
    def of_parts(cls, cut: ChosenCut) -> "ShownLabels":
        said = {} if cut.partition is None else {"parts": [part_document(part) for part in cut.partition.parts]}
        return cls(cut.labels, cut.segments, said)

    @classmethod
    def of_classes(cls, cut: ChosenCut, class_names: list[str]) -> "ShownLabels":
        """Return the classes of the parts: 0 for none, then those of a list, by default all in alphabetical order.

        Raises
        ------
        InvalidParameters
            If the cut is none of a revision, or a part has a class that is not in the list.
        """
        if cut.partition is None:
            raise InvalidParameters("Only parts of revisions have classes: add revision=latest, or leave by=class out.")
        names = list(dict.fromkeys(class_names)) or cut.partition.class_names
        return cls(cut.partition.class_labels(names), len(names) + 1, {"classes": ["", *names]})


def _json(shown: ShownLabels) -> bytes:
    body = labels_json({"segments": shown.count, "labels": shown.numbers.tolist()})
    return with_members(body, compact_json(shown.said)) if shown.said else body


# The first one is the default of a client that accepts any.
LABELS: dict[LabelsFormat, LabelsEncoding] = {
    "json": LabelsEncoding("JSON", "application/json", ".json", _json),
    "runs": LabelsEncoding(
        "JSON, runs of equal labels",
        "application/vnd.cleave.runs+json",
        ".json",
        lambda shown: compact_json(runs_of(shown.numbers, shown.count) | shown.said),
    ),
    "seg": LabelsEncoding(
        "text, one label per line",
        "text/plain; charset=utf-8",
        WRITERS["seg"].extension,
        lambda shown: to_bytes(lambda target: write_seg(target, shown.numbers)),
    ),
    "npy": LabelsEncoding(
        "NumPy array of int32",
        "application/x-npy",
        WRITERS["npy"].extension,
        lambda shown: to_bytes(lambda target: write_npy(target, shown.numbers)),
        is_binary=True,
    ),
    "raw": LabelsEncoding(
        "little-endian int32",
        "application/octet-stream",
        ".bin",
        lambda shown: shown.numbers.astype("<i4").tobytes(),
        is_binary=True,
    ),
}


def labels_rendition(
    cut: ChosenCut,
    format: LabelsFormat | None,  # noqa: A002
    accept: str,
    by: LabelsOf = "part",
    class_names: Sequence[str] = (),
) -> Rendition:
    """Return the labels at a level, in the given format or in the one that an Accept header prefers.

    Parameters
    ----------
    by : whether the numbers are those of parts or of their classes.
    class_names : the classes 1, 2, ..., by default those of the parts in alphabetical order.

    Raises
    ------
    InvalidParameters
        If there are no such classes.
    Problem
        If the header accepts no format.
    """
    name = format or negotiate(accept)
    encoding, identity = LABELS[name], f"{cut.job_id}/labels?{cut.name}&format={name}"
    classes = ShownLabels.of_classes(cut, list(class_names)) if by == "class" else None
    if classes is not None:
        identity += f"&by=class&class={json.dumps(classes.said)}"
    return Rendition(
        identity=identity,
        media_type=encoding.media_type,
        render=lambda: encoding.encode(classes or ShownLabels.of_parts(cut)),
        file_name=f"{cut.job_id}{encoding.extension}" if encoding.is_binary else None,
        vary=None if format else "Accept",
        may_change=cut.is_newest,
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
