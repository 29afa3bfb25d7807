"""The output of the writers as bytes."""

import io
import json
import zipfile

import numpy as np

from segcore.hierarchy import Hierarchy
from segcore.io import WRITERS, write_mesh
from segcore.mesh import Mesh


class Pipe:
    """A target without ``seek`` and ``tell``, such as the body of an HTTP response."""

    def __init__(self) -> None:
        self.pieces: list[bytes] = []

    def write(self, data: bytes) -> int:
        self.pieces.append(bytes(data))
        return len(data)

    def flush(self) -> None:
        pass


def mesh_bytes(mesh: Mesh, format: str) -> bytes:  # noqa: A002
    """A mesh without a segmentation as a file."""
    target = Pipe()
    write_mesh(target, mesh, format)
    return b"".join(target.pieces)


def written(kind: str, mesh: Mesh, hierarchy: Hierarchy, segments: int | None = None, **options: object) -> bytes:
    """The output of a format of WRITERS."""
    target = Pipe()
    WRITERS[kind].write(target, mesh, hierarchy, segments, **options)
    return b"".join(target.pieces)


def members(data: bytes) -> dict[str, bytes]:
    """The members of a ZIP archive."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.testzip() is None
        return {name: archive.read(name) for name in archive.namelist()}


def labels_of_runs(document: dict) -> list[int]:
    """Labels from the run-length form."""
    labels = np.repeat(document["values"], document["lengths"]).tolist()
    assert len(labels) == document["faces"]
    return labels


def json_of(data: bytes) -> dict:
    return json.loads(data)
