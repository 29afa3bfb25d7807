"""Choices that were learned without some models, for an evaluation on these models."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.assets.dataset import Asset
from bench.clicks.evaluation import ClickResult
from bench.errors import BenchmarkError
from bench.learning.folds import read_learned, save_learned
from bench.princeton.dataset import Model

if TYPE_CHECKING:
    from bench.clicks.training import Learned


def save_choices(folder: Path, folds: Sequence[Learned]) -> None:
    """Write a file for each group that was left out."""
    folder.mkdir(parents=True, exist_ok=True)
    for fold in folds:
        save_learned(folder, str(fold.group), fold.left_out, {"choices": fold.models.document()})


def read_choices(folder: Path) -> dict[int | str, dict[str, Any]]:
    """Return, for every model that a file of the folder leaves out, the document of its choices.

    Raises
    ------
    BenchmarkError
        If the folder has no such file, or one cannot be read.
    """
    return read_learned(folder, "choices", "bench clicks --choice-folds")


def apply_choices(
    evaluate: Callable[[Model | Asset], ClickResult],
    choices: Mapping[int | str, Mapping[str, Any]] | None,
    model: Model | Asset,
) -> ClickResult:
    """Return the result for a model, with the choices that were learned without it in use."""
    from segcore.learned.choices import ChoiceModels, using_choices

    if choices is None:
        return evaluate(model)
    if model.key not in choices:
        raise BenchmarkError(f"No file of --choice-folds leaves out model {model.key}.")
    with using_choices(ChoiceModels.from_document(choices[model.key])):
        return evaluate(model)
