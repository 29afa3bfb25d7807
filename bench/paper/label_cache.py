"""A cache of segmentations in a folder, so that a second run computes only the missing ones."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from zipfile import BadZipFile

import numpy as np

from bench.errors import BenchmarkError
from bench.peers.method import Method, MethodFailed, Outcome

if TYPE_CHECKING:
    from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True)
class LabelCache:
    """One file per method and model, valid for one state of the sources, the mesh and the number of segments."""

    folder: Path

    def outcome(self, method: Method, model: int, mesh: Mesh, segments: int) -> Outcome:
        """Return the segmentation of a mesh by a method, from its file or by calling the method.

        A mesh on which the method fails becomes one segment.

        Raises
        ------
        BenchmarkError
            If the file cannot be written, or the method cannot be called.
        """
        path = self.folder / method.key / f"{model}.npz"
        digest = _digest(method, mesh, segments)
        kept = _read(path, digest)
        if kept is not None:
            return kept
        outcome = _call(method, mesh, segments)
        _write(path, digest, outcome)
        return outcome


def _call(method: Method, mesh: Mesh, segments: int) -> Outcome:
    try:
        return method(mesh, segments)
    except MethodFailed as failure:
        return Outcome(np.zeros(len(mesh.faces), dtype=np.int32), 0.0, str(failure))


def _digest(method: Method, mesh: Mesh, segments: int) -> str:
    parts = [method.settings.encode(), str(segments).encode(), mesh.vertices.tobytes(), mesh.faces.tobytes()]
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, "little") + part)
    return digest.hexdigest()


def _read(path: Path, digest: str) -> Outcome | None:
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            if str(file["digest"]) != digest:
                return None
            return Outcome(file["labels"], float(file["cpu_s"]), str(file["failure"]))
    except (OSError, KeyError, ValueError, EOFError, BadZipFile):
        # The file is missing or damaged: compute the segmentation again.
        return None


def _write(path: Path, digest: str, outcome: Outcome) -> None:
    unfinished = path.with_suffix(".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with unfinished.open("wb") as file:
            np.savez_compressed(
                file,
                digest=np.array(digest),
                labels=outcome.labels,
                cpu_s=np.array(outcome.cpu_s),
                failure=np.array(outcome.failure),
            )
        unfinished.replace(path)
    except OSError as error:
        raise BenchmarkError(f"The segmentation cannot be kept in {path}: {error.strerror}.") from error
