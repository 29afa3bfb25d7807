"""Labels that were made elsewhere, in the formats in which the service sends labels."""

import io
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from segcore import InvalidParameters, Part, Partition, partition_of
from service.answer.label_formats import LABELS, LabelsFormat
from service.problems import Problem
from worker.edits.operation_documents import parsed_as

Integers = NDArray[np.integer[Any]]

_Text = Annotated[str, Field(max_length=200, pattern=r"^[^\x00-\x1f\x7f]*$")]
_JSON_SAID = "Each is the entry of the label of that number; entries beyond the labels are ignored."


class UploadedPart(BaseModel):
    """What is said about a part, as in the labels of a revision."""

    model_config = ConfigDict(extra="ignore", strict=True)

    name: _Text = ""
    color: str | None = Field(default=None, pattern=r"^#[0-9a-fA-F]{6}$")
    class_name: _Text = Field(default="", alias="class")
    locked: bool = False

    def part(self) -> Part:
        return Part(self.name.strip(), self.color and self.color.lower(), self.class_name.strip(), self.locked)


class _Said(BaseModel):
    """What a document of labels says about parts."""

    model_config = ConfigDict(extra="ignore", strict=True)

    parts: list[UploadedPart] = Field(default=[], max_length=1_000_000, description=_JSON_SAID)
    classes: list[_Text] = Field(default=[], max_length=1_000_000, description=f"Names of classes. {_JSON_SAID}")

    def part(self, label: int) -> Part:
        part = self.parts[label].part() if label < len(self.parts) else Part()
        if label < len(self.classes) and not part.class_name:
            part = Part(part.name, part.color, self.classes[label].strip(), part.locked)
        return part


class UploadedLabels(_Said):
    """A label for each face of the file, in its order. ``GET labels?format=json`` returns such a document."""

    labels: list[int]


class UploadedRuns(_Said):
    """Labels as runs: the first lengths[0] faces have the label values[0], and so on."""

    values: list[int]
    lengths: list[int]


def read_labels(body: bytes, media_type: str, face_count: int) -> Partition:
    """Return the parts in a body.

    Parameters
    ----------
    media_type : of the body, one of those of LABELS.
    face_count : F, the number of faces of the mesh.

    Raises
    ------
    InvalidParameters
        If the body is not what its type says, or its labels are not those of the mesh.
    Problem
        If labels have no such media type.
    """
    known = {encoding.media_type.partition(";")[0]: name for name, encoding in LABELS.items()}
    if media_type not in known:
        raise Problem("unsupported_media_type", f"Labels are sent as {', '.join(known)}: declare one as Content-Type.")
    labels, said = _READERS[known[media_type]](body, face_count)
    partition, given = partition_of(labels, face_count)
    return Partition(partition.labels, tuple(said.part(label) for label in given))


def _of_json(body: bytes, face_count: int) -> tuple[Integers, _Said]:
    del face_count
    if body.lstrip()[:1] == b"[":
        body = b'{"labels":' + body + b"}"
    document = parsed_as(UploadedLabels, body)
    return _integers(document.labels), document


def _of_runs(body: bytes, face_count: int) -> tuple[Integers, _Said]:
    document = parsed_as(UploadedRuns, body)
    lengths = _integers(document.lengths)
    if len(lengths) != len(document.values) or (lengths < 1).any():
        raise InvalidParameters("Runs of labels need a length of at least 1 for each value.")
    if lengths.sum() != face_count or lengths.max(initial=0) > face_count:
        raise InvalidParameters(f"The lengths of the runs must add up to the {face_count} faces of the file.")
    return np.repeat(_integers(document.values), lengths), document


def _of_text(body: bytes, face_count: int) -> tuple[Integers, _Said]:
    del face_count
    words = body.split()
    try:
        return np.array(words, dtype=np.bytes_).astype(np.int64) if words else np.zeros(0, dtype=np.int64), _Said()
    except (ValueError, OverflowError):
        place = next(i for i, word in enumerate(words) if not _is_integer(word))
        word = words[place][:40].decode("ascii", "backslashreplace")
        raise InvalidParameters(f"Label {place + 1} of the file is {word!r}: a label is a whole number.") from None


def _of_npy(body: bytes, face_count: int) -> tuple[Integers, _Said]:
    file = io.BytesIO(body)
    try:
        version = np.lib.format.read_magic(file)
        read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = read_header(file)
    except (ValueError, EOFError):
        raise InvalidParameters("The body is not a .npy file: save the labels with numpy.save.") from None
    if dtype.hasobject or dtype.kind not in "iu" or len(shape) != 1:
        raise InvalidParameters(f"Labels are an array of integers of shape ({face_count},), not {dtype} of {shape}.")
    data = body[file.tell() :]
    if len(data) != dtype.itemsize * shape[0]:
        raise InvalidParameters("The .npy file is cut short or has data after its array: save it again.")
    return np.frombuffer(data, dtype), _Said()


def _of_raw(body: bytes, face_count: int) -> tuple[Integers, _Said]:
    if len(body) % 4:
        raise InvalidParameters(f"The body must be {face_count} numbers of 4 bytes, not {len(body)} bytes.")
    return np.frombuffer(body, "<i4"), _Said()


_READERS: dict[LabelsFormat, Callable[[bytes, int], tuple[Integers, _Said]]] = {
    "json": _of_json,
    "runs": _of_runs,
    "seg": _of_text,
    "npy": _of_npy,
    "raw": _of_raw,
}


def _integers(values: list[int]) -> Integers:
    """(N,) the values, of which those that are too large for any label are refused."""
    try:
        return np.array(values, dtype=np.int64)
    except OverflowError:
        raise InvalidParameters("A label is larger than 64 bits: labels are numbers from 0 to 999999.") from None


def _is_integer(word: bytes) -> bool:
    return word.removeprefix(b"-").removeprefix(b"+").isdigit() and len(word) < 19
