"""Saves results of the Princeton benchmark as JSON, and reads them for a comparison."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.documents import save_json
from bench.errors import BenchmarkError
from bench.princeton.evaluation import ModelResult, SegmentChoice
from bench.princeton.metrics import METRICS, Scores
from bench.princeton.summary import overall

FORMAT = "cleave-princeton-1"


@dataclass(frozen=True, slots=True)
class SavedResults:
    """The parts of a saved run that a comparison needs."""

    settings: str  # number of segments, seeds and parameters, as text
    scores: dict[int, Scores]  # by model number


def save_results(
    path: Path, results: Sequence[ModelResult], choice: SegmentChoice, parameters: dict[str, object]
) -> None:
    """Write the results as JSON; an undefined score is null.

    Raises
    ------
    BenchmarkError
        If the file cannot be written.
    """
    summary = overall(results)
    document = {
        "format": FORMAT,
        "segments": choice,
        "seeds": [run.seed for run in results[0].runs],
        "parameters": parameters,
        "scores": asdict(summary.scores),
        "people_scores": asdict(summary.people_scores),
        "models": [{**asdict(result), "scores": asdict(result.scores)} for result in results],
    }
    save_json(path, document)


def load_results(path: Path) -> SavedResults:
    """Read a file that ``save_results`` wrote.

    Raises
    ------
    BenchmarkError
        If the file cannot be read or has another format.
    """
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BenchmarkError(f"{path} cannot be read: {error.strerror}.") from error
    except ValueError as error:
        raise BenchmarkError(f"{path} is not JSON: give a file that princeton --output wrote.") from error
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise BenchmarkError(f"{path} is not of format {FORMAT}: give a file that princeton --output wrote.")
    parameters = json.dumps(document["parameters"], sort_keys=True)
    return SavedResults(
        settings=f"segments {document['segments']}, seeds {document['seeds']}, parameters {parameters}",
        scores={entry["model"]: _scores_from_json(entry["scores"]) for entry in document["models"]},
    )


def _scores_from_json(values: dict[str, float | None]) -> Scores:
    return Scores(**{metric: math.nan if (value := values[metric]) is None else value for metric in METRICS})
