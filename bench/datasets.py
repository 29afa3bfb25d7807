"""Functions that the readers of the data sets share."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.arrays import IntArray, LongArray
    from segcore.clean.surface import Surface
    from segcore.mesh import Mesh

Item = TypeVar("Item")


def read_table(path: Path, data: str, columns: str, model: Callable[[dict[str, str]], Item]) -> list[Item]:
    """Read the table of the models of a data set, tab-separated, with a header.

    Parameters
    ----------
    data, columns : the name of the data set and the names of the columns, for messages.
    model : makes a model from a row.

    Raises
    ------
    BenchmarkError
        If the table is missing, empty or malformed.
    """
    try:
        with path.open(newline="", encoding="utf-8") as lines:
            models = [model(row) for row in csv.DictReader(lines, delimiter="\t")]
    except OSError as error:
        raise BenchmarkError(f"{path.parent} is not the folder of the {data}: {path.name} cannot be read.") from error
    except (KeyError, TypeError, ValueError) as error:
        raise BenchmarkError(f"{path} must be a table with the columns {columns}: {error}.") from error
    if not models:
        raise BenchmarkError(f"{path} lists no model.")
    return models


def spread_evenly(models: Sequence[Item], limit: int | None) -> list[Item]:
    """Return at most ``limit`` models, spread evenly over the list and so over its categories; all if it is None.

    Raises
    ------
    BenchmarkError
        If the limit is below 1.
    """
    if limit is None:
        return list(models)
    if limit < 1:
        raise BenchmarkError(f"The limit must be at least 1 model, not {limit}.")
    count = min(limit, len(models))
    return [models[i * len(models) // count] for i in range(count)]


def read_mesh(path: Path, name: str) -> Mesh:
    """Read the mesh of a model.

    Raises
    ------
    BenchmarkError
        If the file is missing or cannot be read; the message contains ``name``.
    """
    # Imported here so that listing commands and comparing results do not load the compiled kernels.
    from segcore import io
    from segcore.errors import CleaveError

    try:
        return io.read_mesh(path)
    except (OSError, CleaveError) as error:
        raise BenchmarkError(f"Model {name} cannot be read: {error}") from error


def read_labels(path: Path, face_count: int) -> LongArray:
    """(F,) labels of a .seg file: one integer per line, line i for face i.

    Raises
    ------
    BenchmarkError
        If the file does not contain ``face_count`` integers.
    """
    try:
        labels = np.array(path.read_text(encoding="ascii").split(), dtype=np.int64)
    except (OSError, ValueError) as error:
        raise BenchmarkError(f"{path} is not a list of integers: {error}") from error
    if labels.shape != (face_count,):
        raise BenchmarkError(f"{path} must have one label for each of {face_count} faces, not {labels.size}.")
    return labels


def on_surface(surface: Surface, labels: IntArray | LongArray) -> LongArray:
    """(F,) labels of the faces of the surface, from the labels of the input faces."""
    of_face = np.zeros(len(surface.faces), dtype=np.int64)
    of_face[surface.face_of_input] = labels
    return of_face
