"""Arguments that several commands take, and the checks of their values."""

import argparse
import json
from pathlib import Path

from bench.errors import BenchmarkError


def add_jobs(parser: argparse.ArgumentParser) -> None:
    """Add --jobs; ``require_jobs`` checks it."""
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes of one thread each (default 1)")


def add_parameters(parser: argparse.ArgumentParser) -> None:
    """Add --parameters; ``parameters_of`` returns them."""
    parser.add_argument(
        "--parameters",
        type=parameter,
        nargs="+",
        default=[],
        metavar="KEY=VALUE",
        help="parameters of the segmentation, with the names in segcore.SegmentationParameters",
    )


def add_folds(parser: argparse.ArgumentParser, name: str) -> None:
    """Add the option ``name`` for a folder that ``bench.learning.folds.read_folds`` reads."""
    parser.add_argument(
        name,
        type=Path,
        metavar="FOLDER",
        help="segment every model with what was learned without it (by python -m bench train --folds FOLDER)",
    )


def parameters_of(arguments: argparse.Namespace, seed_option: str) -> dict[str, object]:
    """Return the parameters of the segmentation by their names.

    Raises
    ------
    BenchmarkError
        If the seed, which has an option of its own, is one of them.
    """
    parameters = dict(arguments.parameters)
    if "seed" in parameters:
        raise BenchmarkError(f"The seed is not one of --parameters: give it with {seed_option}.")
    return parameters


def require_jobs(jobs: int) -> None:
    """Check the number of processes.

    Raises
    ------
    BenchmarkError
        If it is less than 1.
    """
    if jobs < 1:
        raise BenchmarkError(f"--jobs must be at least 1, not {jobs}.")


def require_folder_of(path: Path) -> None:
    """Check that a file can be written after a long run.

    Raises
    ------
    BenchmarkError
        If its folder does not exist.
    """
    if not path.parent.is_dir():
        raise BenchmarkError(f"The folder of {path} does not exist: create it first.")


def parameter(text: str) -> tuple[str, object]:
    """Return a name and a value, which is parsed as JSON if possible (numbers, true, null) and a word otherwise.

    Raises
    ------
    ArgumentTypeError
        If the text is not KEY=VALUE.
    """
    name, equals, value = text.partition("=")
    if not name or not equals:
        raise argparse.ArgumentTypeError(f"a parameter is KEY=VALUE, not {text!r}")
    try:
        return name, json.loads(value)
    except ValueError:
        return name, value
