"""Writes results as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path

from bench.errors import BenchmarkError


def save_json(path: Path, document: Mapping[str, object], name: str = "results") -> None:
    """Write a document as JSON; an undefined value (nan) is null, at every depth.

    Parameters
    ----------
    name : of what is written, in plural, for the message.

    Raises
    ------
    BenchmarkError
        If the file cannot be written.
    """
    try:
        path.write_text(json.dumps(_defined(document), indent=1, allow_nan=False) + "\n", encoding="utf-8")
    except OSError as error:
        raise BenchmarkError(f"The {name} cannot be written to {path}: {error.strerror}.") from error


def _defined(value: object) -> object:
    if isinstance(value, Mapping):
        return {key: _defined(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_defined(one) for one in value]
    return None if isinstance(value, float) and math.isnan(value) else value
