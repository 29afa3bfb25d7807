"""Evaluates many assets in several processes, with models that have not seen them if that is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from bench.assets.dataset import Asset
from bench.assets.evaluation import Evaluation, evaluate_asset
from bench.learning.folds import Documents, apply_unseen, with_unseen
from bench.pool import map_in_processes
from bench.segmenter import CleaveSegmenter


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
    evaluate = partial(evaluate_asset, segmenter=segmenter, seed=seed, drawn=drawn)
    return map_in_processes(partial(apply_unseen, evaluate), with_unseen(assets, learned), jobs, segmenter.warm_up)
