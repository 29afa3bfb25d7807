"""Quality on the Princeton Segmentation Benchmark: the four metrics against every person's segmentation.

The folder given with --data contains segments.tsv (columns model, category, segments), the meshes off/N.off and the
segmentations by people seg/Benchmark/N/N_j.seg. The last row is that of the people, each compared with the others.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import get_args

from bench.arguments import add_folds, add_jobs, add_parameters, parameters_of, require_folder_of, require_jobs
from bench.learning.folds import read_folds
from bench.princeton.dataset import read_models
from bench.princeton.evaluation import SegmentChoice
from bench.princeton.parallel import evaluate_models
from bench.princeton.report import render
from bench.princeton.results import save_results
from bench.segmenter import CleaveSegmenter


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, required=True, metavar="DIR", help="the folder of the benchmark")
    parser.add_argument("--limit", type=int, metavar="N", help="only N models, spread evenly over the list")
    parser.add_argument(
        "--segments",
        choices=get_args(SegmentChoice),
        default="given",
        help="given: the most frequent number of the people, from segments.tsv (default); automatic: chosen by Cleave",
    )
    parser.add_argument(
        "--seeds",
        type=_seeds,
        default=(0,),
        metavar="S,S",
        help="segment once with each of these seeds (default 0)",
    )
    add_jobs(parser)
    parser.add_argument("--output", type=Path, metavar="FILE", help="write the scores of every model to this JSON file")
    add_parameters(parser)
    add_folds(parser, "--learned")


def run(arguments: argparse.Namespace) -> None:
    parameters = parameters_of(arguments, "--seeds")
    require_jobs(arguments.jobs)
    if arguments.output is not None:
        require_folder_of(arguments.output)
    segmenter = CleaveSegmenter(parameters)
    models = read_models(arguments.data, arguments.limit)
    learned = None if arguments.learned is None else read_folds(arguments.learned)
    results = evaluate_models(models, segmenter, arguments.seeds, arguments.segments, arguments.jobs, learned)
    if arguments.output is not None:
        save_results(arguments.output, results, arguments.segments, parameters)
    print(render(results, arguments.segments))


def _seeds(text: str) -> tuple[int, ...]:
    try:
        seeds = tuple(int(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"seeds are integers with commas between them, not {text!r}") from None
    if len(set(seeds)) < len(seeds):
        raise argparse.ArgumentTypeError(f"each seed may appear once only, not as in {text!r}")
    return seeds
