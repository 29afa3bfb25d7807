"""Evaluates many assets in several processes, with models that have not seen them if that is asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from bench.assets.dataset import Asset
from bench.assets.evaluation import Evaluation, evaluate_asset
from bench.errors import BenchmarkError
from bench.pool import map_in_processes
from bench.segmenter import CleaveSegmenter

Documents = Mapping[int | str, Mapping[str, Any]]  # learned models by the mesh that they have not seen


def evaluate_assets(
    assets: Sequence[Asset],
    segmenter: CleaveSegmenter,
    seed: int,
    jobs: int,
    learned: Documents | None = None,
    drawn: bool = False,
) -> list[Evaluation]:
    """Return the results of all assets, in their order, computed in ``jobs`` processes of one thread each.

    Parameters
    ----------
    learned : for every asset, by SET/NAME, the learned models to use; None for the ones that ship.
    drawn : also draw every asset.

    Raises
    ------
    BenchmarkError
        If ``learned`` lacks an asset, an asset fails, or a process dies.
    """
    evaluate = partial(_evaluate, segmenter, seed, drawn)
    return map_in_processes(evaluate, with_unseen(assets, learned), jobs, segmenter.warm_up)


def with_unseen(assets: Sequence[Asset], learned: Documents | None) -> list[tuple[Asset, Mapping[str, Any] | None]]:
    """Return every asset with the document of the learned models that have not seen it; None for those that ship.

    Raises
    ------
    BenchmarkError
        If ``learned`` lacks an asset.
    """
    if learned is None:
        return [(asset, None) for asset in assets]
    missing = [asset.key for asset in assets if asset.key not in learned]
    if missing:
        raise BenchmarkError(
            f"No fold leaves out model {missing[0]} ({len(missing)} of {len(assets)} models are in no fold): "
            "train the folds on the same models."
        )
    return [(asset, learned[asset.key]) for asset in assets]


def _evaluate(
    segmenter: CleaveSegmenter, seed: int, drawn: bool, asset_and_models: tuple[Asset, Mapping[str, Any] | None]
) -> Evaluation:
    from segcore.learned.models import LearnedModels, using

    asset, document = asset_and_models
    if document is None:
        return evaluate_asset(asset, segmenter, seed, drawn)
    with using(LearnedModels.from_document(document)):
        return evaluate_asset(asset, segmenter, seed, drawn)
