"""Results that a server has for a finished job: their names on the command line, their paths, and their files."""

import argparse
from dataclasses import dataclass, field
from pathlib import Path

from cleave.client import Client
from segcore.io.writing import WRITERS


@dataclass(frozen=True, slots=True)
class ServerResult:
    """A result of a job."""

    extension: str  # without the dot
    path: str  # below the path of the job
    params: dict[str, object] = field(default_factory=dict)
    has_level: bool = True  # False if the result is the same for every number of segments
    is_closed: bool = False  # the parts are closed at their cuts unless the request says otherwise


def _models() -> dict[str, ServerResult]:
    """The formats of meshes, as :mod:`service.routes.models` serves them."""
    models = {name: writer for name, writer in WRITERS.items() if "names" in writer.options}
    return {
        name: ServerResult(
            writer.extension.removeprefix("."),
            "parts.zip" if name == "zip" else f"model{writer.extension}",
            is_closed="capped" in writer.options,
        )
        for name, writer in models.items()
    }


RESULTS = {
    **{name: ServerResult(name, "labels", {"format": name}) for name in ("seg", "npy")},
    "json": ServerResult("json", "hierarchy", has_level=False),
    **_models(),
    "kept": ServerResult("kept.glb", "model.glb", {"keep": "all"}),
    "png": ServerResult("png", "preview.png"),
}
DEFAULT_RESULTS = ("seg", "json", "glb")


def result_names(text: str) -> tuple[str, ...]:
    """The type of an argument that is a list of keys of RESULTS."""
    chosen = tuple(part.strip() for part in text.split(",") if part.strip())
    unknown = [part for part in chosen if part not in RESULTS]
    if unknown or not chosen:
        raise argparse.ArgumentTypeError(f"results are {', '.join(RESULTS)}, not {text!r}")
    return chosen


def save_result(
    client: Client, job_id: str, name: str, target: Path, level: dict[str, object], open_parts: bool = False
) -> None:
    """Save a result of a finished job in a file, completely or not at all.

    Parameters
    ----------
    name : a key of RESULTS.
    level : query parameters of the number of segments.
    open_parts : do not close the parts at their cuts.
    """
    result = RESULTS[name]
    params = {**(level if result.has_level else {}), **result.params}
    if open_parts and result.is_closed:
        params["capped"] = False
    client.download(job_id, result.path, target, **params)
