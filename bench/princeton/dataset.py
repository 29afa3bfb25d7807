"""The Princeton Segmentation Benchmark as a folder: meshes, people's segmentations, numbers of segments."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.arrays import LongArray
    from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True)
class Model:
    """One model of the benchmark: where its files are, and how many segments people give it."""

    number: int
    category: str
    segments: int  # the most frequent number of segments over its people
    mesh_path: Path  # off/N.off
    people_folder: Path  # seg/Benchmark/N, one N_j.seg for every person

    def read_mesh(self) -> Mesh:
        """The mesh of the model.

        Raises
        ------
        BenchmarkError
            Where the file is missing or cannot be read.
        """
        # Imported here so that listing commands and comparing results do not load the compiled kernels.
        from segcore.errors import CleaveError
        from segcore.io import read_mesh

        try:
            return read_mesh(self.mesh_path)
        except (OSError, CleaveError) as error:
            raise BenchmarkError(f"Model {self.number} cannot be read: {error}") from error

    def read_people(self, face_count: int) -> list[LongArray]:
        """The segmentations (F,) of all people of the model, in the order of their numbers.

        Raises
        ------
        BenchmarkError
            Where there is none, or one is not a list of ``face_count`` integers.
        """
        paths = sorted(self.people_folder.glob(f"{self.number}_*.seg"), key=_person)
        if not paths:
            raise BenchmarkError(f"There are no {self.number}_*.seg files in {self.people_folder}.")
        return [read_labels(path, face_count) for path in paths]


def read_models(folder: Path, limit: int | None = None) -> list[Model]:
    """The models listed in ``folder``/segments.tsv, in order of their numbers.

    Parameters
    ----------
    folder : holds segments.tsv (columns model, category, segments), off/N.off and seg/Benchmark/N/N_j.seg.
    limit : take this many models, spread evenly over the list and so over the categories; all by default.

    Raises
    ------
    BenchmarkError
        Where the list is missing, empty or malformed, or the limit is below 1.
    """
    models = sorted(_listed_models(folder), key=lambda model: model.number)
    if limit is None:
        return models
    if limit < 1:
        raise BenchmarkError(f"The limit must be at least 1 model, not {limit}.")
    count = min(limit, len(models))
    return [models[i * len(models) // count] for i in range(count)]


def read_labels(path: Path, face_count: int) -> LongArray:
    """(F,): the labels in a .seg file, one integer in a line, line i for face i.

    Raises
    ------
    BenchmarkError
        Where the file does not hold ``face_count`` integers.
    """
    try:
        labels = np.array(path.read_text(encoding="ascii").split(), dtype=np.int64)
    except (OSError, ValueError) as error:
        raise BenchmarkError(f"{path} is not a list of integers: {error}") from error
    if labels.shape != (face_count,):
        raise BenchmarkError(f"{path} must have one label for each of {face_count} faces, not {labels.size}.")
    return labels


def _listed_models(folder: Path) -> list[Model]:
    path = folder / "segments.tsv"
    try:
        with path.open(newline="", encoding="utf-8") as lines:
            models = [_model(folder, row) for row in csv.DictReader(lines, delimiter="\t")]
    except OSError as error:
        raise BenchmarkError(f"{folder} is not the folder of the benchmark: segments.tsv cannot be read.") from error
    except (KeyError, TypeError, ValueError) as error:
        raise BenchmarkError(f"{path} must be a table with the columns model, category, segments: {error}.") from error
    if not models:
        raise BenchmarkError(f"{path} lists no model.")
    return models


def _model(folder: Path, row: dict[str, str]) -> Model:
    number = int(row["model"])
    return Model(
        number=number,
        category=row["category"],
        segments=int(row["segments"]),
        mesh_path=folder / "off" / f"{number}.off",
        people_folder=folder / "seg" / "Benchmark" / str(number),
    )


def _person(path: Path) -> tuple[int, str]:
    person = path.stem.rpartition("_")[2]
    return (int(person), "") if person.isdecimal() else (0, person)
