"""The learned models that ship with the package."""

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from segcore.logistic import LogisticModel


@dataclass(frozen=True, slots=True, eq=False)
class LearnedModels:
    """What ``python -m bench train`` has learned."""

    version: str
    boundary: LogisticModel  # of a cut along an edge, see segcore.boundary_model


@cache
def learned_models() -> LearnedModels:
    """The models of the data file learned.json in this package."""
    document = json.loads(files("segcore").joinpath("learned.json").read_text(encoding="utf-8"))
    return LearnedModels(
        version=document["version"],
        boundary=LogisticModel.from_document(document["boundary"]),
    )
