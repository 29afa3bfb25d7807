"""The meshes and parameters of which digests are recorded."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bench.assets.dataset import Asset, read_assets
from bench.princeton.dataset import Model, find_models, read_models
from segcore.parameters import parameters_schema


@dataclass(frozen=True, slots=True)
class Subject:
    """A mesh and the parameters with which it is segmented."""

    name: str  # psb/NUMBER or assets/SET/NAME
    path: Path
    parameters: dict[str, object] = field(default_factory=dict)

    @property
    def key(self) -> str:
        """The name, and the parameters as JSON if there are any."""
        return f"{self.name} {json.dumps(self.parameters, sort_keys=True)}" if self.parameters else self.name


def models_of(data: Path, assets: Path, limit: int) -> list[Subject]:
    """Return models of both data sets, spread evenly, with the default parameters.

    Raises
    ------
    BenchmarkError
        If a list of models cannot be read, or the limit is below 1.
    """
    return [
        *(_princeton(model) for model in read_models(data, limit)),
        *(_asset(asset) for asset in read_assets(assets, limit)),
    ]


def choices_of(data: Path, assets: Path, numbers: list[int]) -> list[Subject]:
    """Return some models of the Princeton benchmark and the first asset, with every choice of parameters.

    Raises
    ------
    BenchmarkError
        If a list of models cannot be read, or lacks one of the numbers.
    """
    subjects = [
        *(_princeton(model) for model in find_models(data, numbers)),
        *(_asset(asset) for asset in read_assets(assets)[:1]),
    ]
    return [Subject(one.name, one.path, choice) for one in subjects for choice in choices()]


def choices() -> Sequence[dict[str, object]]:
    """Return parameters that cover every preset, solver, affinity, order, thinning and graph."""
    values = {name: schema.get("enum", []) for name, schema in parameters_schema()["properties"].items()}
    one_each = [{name: value} for name in ("preset", "solver", "affinity", "order") for value in values[name]]
    return [
        *one_each,
        # Thinning is part of affinity minima_rule; the default affinity does not support the graph of the vertices.
        *({"graph": "vertices", "affinity": "minima_rule", "thinning": value} for value in values["thinning"]),
        {"clusters": 0},
        {"seed": 3},
        {"max_segments": 200},
    ]


def _princeton(model: Model) -> Subject:
    return Subject(f"psb/{model.number}", model.mesh_path)


def _asset(asset: Asset) -> Subject:
    return Subject(f"assets/{asset.collection}/{asset.name}", asset.mesh_path)
