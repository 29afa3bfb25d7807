"""What was learned without some models, in a folder of files: to judge it on just those."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.learned.models import LearnedModels


@dataclass(frozen=True, slots=True, eq=False)
class Fold:
    """Models that are left out together, and what was learned without them."""

    name: str
    left_out: frozenset[int]
    models: LearnedModels


def save_fold(folder: Path, fold: Fold) -> None:
    document = {"left_out": sorted(fold.left_out), "models": fold.models.document()}
    (folder / f"{fold.name.lower()}.json").write_text(json.dumps(document), encoding="utf-8")


def read_folds(folder: Path) -> dict[int, dict[str, Any]]:
    """For every model that some file of the folder leaves out, the document of the learned models in it.

    Raises
    ------
    BenchmarkError
        Where the folder has no such file, or one cannot be read.
    """
    found: dict[int, dict[str, Any]] = {}
    for path in sorted(folder.glob("*.json")):
        try:
            document = json.loads(path.read_text(encoding="utf-8"))
            found.update(dict.fromkeys(document["left_out"], document["models"]))
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise BenchmarkError(f"{path} was not written by 'bench train --folds': {error!r}.") from error
    if not found:
        raise BenchmarkError(f"{folder} has no files of 'bench train --folds'.")
    return found
