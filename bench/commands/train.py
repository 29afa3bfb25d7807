"""Learn from people's cuts: write segcore/learned/models.json, and the files to evaluate it on unseen shapes.

One file is learned from all meshes of the benchmark folder and, with --assets, of the folder of the authored assets.
With --folds, one more file is learned for every group of meshes without this group, for "python -m bench princeton
--learned FOLDER" and "python -m bench assets --folds FOLDER". The same folders always give the same bytes.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import get_args

from bench.arguments import add_jobs, require_folder_of, require_jobs
from bench.assets.dataset import read_assets
from bench.learning.examples import examples
from bench.learning.folds import save_fold
from bench.learning.training import Grouping, train
from bench.princeton.dataset import read_models

_SHIPPED = Path(__file__).parents[2] / "segcore" / "learned" / "models.json"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, required=True, metavar="DIR", help="the folder of the benchmark")
    parser.add_argument("--assets", type=Path, metavar="DIR", help="the folder of the authored assets")
    parser.add_argument(
        "--limit", type=int, metavar="N", help="only N meshes of each folder, spread evenly over its list"
    )
    parser.add_argument(
        "--output", type=Path, default=_SHIPPED, metavar="FILE", help="default: segcore/learned/models.json"
    )
    parser.add_argument(
        "--leave-out",
        choices=get_args(Grouping),
        default="category",
        help="the meshes that are left out together: a category or set (default, as for segcore/learned/models.json), "
        "or every fifth mesh",
    )
    parser.add_argument(
        "--folds", type=Path, metavar="FOLDER", help="write what was learned without each group to this folder"
    )
    add_jobs(parser)


def run(arguments: argparse.Namespace) -> None:
    require_jobs(arguments.jobs)
    require_folder_of(arguments.output)
    models = read_models(arguments.data, arguments.limit)
    assets = read_assets(arguments.assets, arguments.limit) if arguments.assets else []
    everything, *folds = train(examples(models, assets), arguments.leave_out, arguments.jobs)
    arguments.output.write_text(json.dumps(everything.models.document(), indent=1) + "\n", encoding="utf-8")
    if arguments.folds is not None:
        arguments.folds.mkdir(parents=True, exist_ok=True)
        for fold in folds:
            save_fold(arguments.folds, fold)
    print(f"Wrote {arguments.output}" + (f" and {len(folds)} files in {arguments.folds}" if arguments.folds else ""))
