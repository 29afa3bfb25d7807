"""Clicks until a part is right: a simulated person marks the parts of people's and authors' segmentations.

The folder given with --data is that of the benchmark or, with --assets, that of the authored assets. For each part
with more than 1 % of the area, the first click is at its middle, each next one at the middle of the largest region
that is wrong. Beside segcore.Guide the table has plain region growing and the best single node of the hierarchy.

--train FILE learns the choices of segcore.edit from both folders and writes them to a file; with --choice-folds FOLDER
one more file is written for every category and set without it. Without --train, --choice-folds evaluates every model
with the file that has not seen it.

--sizes measures the CPU time of clicks on a procedural shape of these numbers of faces instead.
"""

from __future__ import annotations

import argparse
import json
from functools import partial
from pathlib import Path

from bench.arguments import add_folds, add_jobs, require_folder_of, require_jobs
from bench.assets.dataset import Asset, read_assets
from bench.clicks.evaluation import evaluate_clicks
from bench.clicks.report import render
from bench.clicks.sizes import render_sizes
from bench.clicks.unseen import apply_choices, read_choices, save_choices
from bench.errors import BenchmarkError
from bench.learning.folds import apply_unseen, read_folds, with_unseen
from bench.pool import map_in_processes
from bench.princeton.dataset import Model, read_models
from bench.segmenter import CleaveSegmenter


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, metavar="DIR", help="the folder of the benchmark")
    parser.add_argument("--assets", type=Path, metavar="DIR", help="the folder of the authored assets")
    parser.add_argument("--limit", type=int, metavar="N", help="only N models of each folder, spread evenly")
    parser.add_argument("--people", type=int, metavar="N", help="only the first N people of every model")
    add_folds(parser, "--folds")
    parser.add_argument("--train", type=Path, metavar="FILE", help="learn, and write the file")
    parser.add_argument("--choice-folds", type=Path, metavar="FOLDER", help="what was learned without each group")
    parser.add_argument("--sizes", type=int, nargs="+", metavar="FACES", help="only the time of clicks at these sizes")
    add_jobs(parser)


def run(arguments: argparse.Namespace) -> None:
    require_jobs(arguments.jobs)
    if arguments.sizes is not None:
        print(render_sizes(arguments.sizes))
        return
    models: list[Model | Asset] = []
    if arguments.data is not None:
        models += read_models(arguments.data, arguments.limit)
    if arguments.assets is not None:
        models += read_assets(arguments.assets, arguments.limit)
    if not models:
        raise BenchmarkError("Give a folder of models with --data or --assets.")
    learned = None if arguments.folds is None else read_folds(arguments.folds)
    segmenter = CleaveSegmenter()
    if arguments.train is not None:
        from bench.clicks.training import train

        require_folder_of(arguments.train)
        everything, *folds = train(models, segmenter, arguments.people, learned, arguments.jobs)
        arguments.train.write_text(json.dumps(everything.models.document(), indent=1) + "\n", encoding="utf-8")
        if arguments.choice_folds is not None:
            save_choices(arguments.choice_folds, folds)
        print(f"Wrote {arguments.train}.")
        return
    choices = None if arguments.choice_folds is None else read_choices(arguments.choice_folds)
    evaluate = partial(apply_choices, partial(evaluate_clicks, segmenter=segmenter, people=arguments.people), choices)
    print(
        render(
            map_in_processes(
                partial(apply_unseen, evaluate), with_unseen(models, learned), arguments.jobs, segmenter.warm_up
            )
        )
    )
