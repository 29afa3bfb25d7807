"""Quality on authored assets: one hierarchy of every mesh against the parts that its author made.

The folder given with --data contains models.tsv (columns set, name, parts, kmeans_1rand), the meshes SET/NAME.ply and
the parts SET/NAME.seg. Every mesh is segmented once; the number of parts given and the automatic number are levels of
the same hierarchy, and the best level is the one with the least 1-Rand of all. 1-Rand and IoU are weighted by area,
over the faces that belong to a part.

components and k-means are trivial methods: the connected components after welding, and k-means of the face centroids
with the true number (from models.tsv). flat is the share of the automatic cut's length that runs between faces
coplanar to within a degree. mirror is 1-Rand of the automatic labels against their own mirror image, for the set
bodies. halved counts the models of which half or fewer of the parts are found.

--sheet draws a contact sheet of every set: the automatic segments of every model, then the parts of its author. A
segment has the colour of the part that it is matched to; faces without a part are grey.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from bench.arguments import add_folds, add_jobs, add_parameters, parameters_of, require_folder_of, require_jobs
from bench.assets.dataset import read_assets
from bench.assets.parallel import evaluate_assets
from bench.assets.report import render, save
from bench.assets.sheet import save_sheets
from bench.learning.folds import read_folds
from bench.paper.charts import require_matplotlib
from bench.segmenter import CleaveSegmenter


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, required=True, metavar="DIR", help="the folder of the assets")
    parser.add_argument("--limit", type=int, metavar="N", help="only N models, spread evenly over the list")
    parser.add_argument("--set", nargs="+", metavar="NAME", help="only the models of these sets")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="the seed of the segmentation (default 0)")
    add_jobs(parser)
    parser.add_argument("--output", type=Path, metavar="FILE", help="write the results of every model to this file")
    add_parameters(parser)
    add_folds(parser, "--folds")
    parser.add_argument(
        "--sheet", type=Path, metavar="FOLDER", help="write a picture SET.png of every set to this folder"
    )


def run(arguments: argparse.Namespace) -> None:
    parameters = parameters_of(arguments, "--seed")
    require_jobs(arguments.jobs)
    if arguments.output is not None:
        require_folder_of(arguments.output)
    if arguments.sheet is not None:
        require_matplotlib("--sheet")
    segmenter = CleaveSegmenter(parameters)
    assets = read_assets(arguments.data, arguments.limit, arguments.set)
    learned = None if arguments.folds is None else read_folds(arguments.folds)
    drawn = arguments.sheet is not None
    evaluations = evaluate_assets(assets, segmenter, arguments.seed, arguments.jobs, learned, drawn)
    results = [evaluation.result for evaluation in evaluations]
    if arguments.output is not None:
        save(arguments.output, results, {"seed": arguments.seed, "parameters": parameters})
    print(render(results))
    if drawn:
        print(f"Drawn: {', '.join(map(str, save_sheets(arguments.sheet, evaluations)))}.")
