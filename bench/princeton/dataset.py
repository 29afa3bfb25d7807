"""The Princeton Segmentation Benchmark as a folder: meshes, people's segmentations, numbers of segments."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from bench.datasets import read_labels, read_mesh, read_table, spread_evenly
from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.arrays import LongArray
    from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True)
class Model:
    """One model of the benchmark: the paths of its files, and the number of segments that people give it."""

    number: int
    category: str
    segments: int  # the most frequent number of segments over its people
    mesh_path: Path  # off/N.off
    people_folder: Path  # seg/Benchmark/N, one N_j.seg for every person

    @property
    def key(self) -> int:
        """The number of the model, its name in files and messages."""
        return self.number

    def read_mesh(self) -> Mesh:
        """Read the mesh of the model.

        Raises
        ------
        BenchmarkError
            If the file is missing or cannot be read.
        """
        return read_mesh(self.mesh_path, str(self.number))

    def read_people(self, face_count: int) -> list[LongArray]:
        """Read the segmentations (F,) of all people of the model, in the order of their numbers.

        Raises
        ------
        BenchmarkError
            If there is none, or one is not a list of ``face_count`` integers.
        """
        paths = sorted(self.people_folder.glob(f"{self.number}_*.seg"), key=_person)
        if not paths:
            raise BenchmarkError(f"There are no {self.number}_*.seg files in {self.people_folder}.")
        return [read_labels(path, face_count) for path in paths]


def read_models(folder: Path, limit: int | None = None) -> list[Model]:
    """Read the list of models ``folder``/segments.tsv, in order of their numbers.

    Parameters
    ----------
    folder : contains segments.tsv (columns model, category, segments), off/N.off and seg/Benchmark/N/N_j.seg.
    limit : return at most this many models, spread evenly over the list and so over the categories.

    Raises
    ------
    BenchmarkError
        If the list is missing, empty or malformed, or the limit is below 1.
    """
    return spread_evenly(sorted(_listed_models(folder), key=lambda model: model.number), limit)


def find_models(folder: Path, numbers: list[int]) -> list[Model]:
    """Read the list of models and return those with these numbers, in the order of the numbers.

    Raises
    ------
    BenchmarkError
        If the list is missing, empty or malformed, or does not contain a number.
    """
    by_number = {model.number: model for model in read_models(folder)}
    missing = [number for number in numbers if number not in by_number]
    if missing:
        raise BenchmarkError(f"There is no model {missing[0]} in {folder}.")
    return [by_number[number] for number in numbers]


def _listed_models(folder: Path) -> list[Model]:
    return read_table(folder / "segments.tsv", "benchmark", "model, category, segments", partial(_model, folder))


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
