"""Saves models that were learned without some meshes, for an evaluation on these meshes."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.learned.models import LearnedModels

Document = Mapping[str, Any]  # of learned models
Documents = Mapping[int | str, Document]  # by the mesh that the models have not seen


class Keyed(Protocol):
    """A mesh of a data set."""

    @property
    def key(self) -> int | str:
        """The number of a model of the benchmark, SET/NAME of an authored asset."""


Mesh = TypeVar("Mesh", bound=Keyed)
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True, eq=False)
class Fold:
    """A group of models, and what was learned without them."""

    name: str
    left_out: frozenset[int | str]  # numbers of models of the benchmark, SET/NAME of authored assets
    models: LearnedModels


def save_fold(folder: Path, fold: Fold) -> None:
    """Write a fold to a file of the folder, with the name of the fold in lower case."""
    save_learned(folder, fold.name, fold.left_out, {"models": fold.models.document()})


def save_learned(folder: Path, name: str, left_out: Set[int | str], learned: Document) -> None:
    """Write what was learned without some meshes to a file of the folder, with a name in lower case."""
    document = {"left_out": sorted(left_out, key=_numbers_first), **learned}
    (folder / f"{name.lower()}.json").write_text(json.dumps(document), encoding="utf-8")


def _numbers_first(model: int | str) -> tuple[int, str]:
    return (model, "") if isinstance(model, int) else (sys.maxsize, model)


def read_folds(folder: Path) -> dict[int | str, dict[str, Any]]:
    """Return, for every model that a file of the folder leaves out, the document of the learned models in this file.

    A model of the benchmark is its number, an authored asset the string SET/NAME.

    Raises
    ------
    BenchmarkError
        If the folder has no such file, or one cannot be read.
    """
    return read_learned(folder, "models", "bench train --folds")


def read_learned(folder: Path, field: str, command: str) -> dict[int | str, dict[str, Any]]:
    """Return, for every mesh that a file of the folder leaves out, a field of that file.

    Parameters
    ----------
    command : writes such files.

    Raises
    ------
    BenchmarkError
        If the folder has no such file, or one cannot be read.
    """
    found: dict[int | str, dict[str, Any]] = {}
    for path in sorted(folder.glob("*.json")):
        try:
            document = json.loads(path.read_text(encoding="utf-8"))
            found.update(dict.fromkeys(document["left_out"], document[field]))
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise BenchmarkError(f"{path} was not written by '{command}': {error!r}.") from error
    if not found:
        raise BenchmarkError(f"{folder} has no files of '{command}'.")
    return found


def with_unseen(meshes: Sequence[Mesh], learned: Documents | None) -> list[tuple[Mesh, Document | None]]:
    """Return every mesh with the document of the learned models that have not seen it; None for those that ship.

    Raises
    ------
    BenchmarkError
        If ``learned`` lacks a mesh.
    """
    if learned is None:
        return [(mesh, None) for mesh in meshes]
    missing = [mesh.key for mesh in meshes if mesh.key not in learned]
    if missing:
        raise BenchmarkError(
            f"No fold leaves out model {missing[0]} ({len(missing)} of {len(meshes)} models are in no fold): "
            "train the folds on the same models."
        )
    return [(mesh, learned[mesh.key]) for mesh in meshes]


def apply_unseen(function: Callable[[Mesh], Result], mesh_and_models: tuple[Mesh, Document | None]) -> Result:
    """Return the result for a mesh of ``with_unseen``, with the learned models that it comes with in use."""
    from segcore.learned.models import LearnedModels, using

    mesh, document = mesh_and_models
    if document is None:
        return function(mesh)
    with using(LearnedModels.from_document(document)):
        return function(mesh)
