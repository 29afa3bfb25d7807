"""The same evaluation of many models, in several processes."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from multiprocessing import get_context
from typing import Any, TypeVar

from bench.errors import BenchmarkError
from bench.princeton.dataset import Model
from bench.princeton.evaluation import ModelResult, SegmentChoice, Segmenter, evaluate_model

Item = TypeVar("Item")
Result = TypeVar("Result")

# What numerical libraries read when they are loaded, to decide how many threads they start.
THREAD_SETTINGS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def evaluate_models(
    models: Sequence[Model],
    segmenter: Segmenter,
    seeds: tuple[int, ...],
    choice: SegmentChoice,
    jobs: int,
    learned: Mapping[int, Mapping[str, Any]] | None = None,
) -> list[ModelResult]:
    """The results of all models, in their order, computed in ``jobs`` processes of one thread each.

    CPU times are comparable between numbers of jobs: every process is warmed up before its first model, and its
    numerical libraries start no threads of their own unless the environment says how many.

    Parameters
    ----------
    learned : for every model, by its number, the learned models to go by; by default those that ship.

    Raises
    ------
    BenchmarkError
        Where one model fails, or a process dies.
    """
    evaluate = partial(evaluate_model, segmenter=segmenter, seeds=seeds, choice=choice)
    if learned is not None:
        missing = [model.number for model in models if model.number not in learned]
        if missing:
            raise BenchmarkError(f"No fold leaves out model {missing[0]}: train the folds on the same models.")
        evaluate = partial(_evaluate_unseen, learned, evaluate)
    return map_in_processes(evaluate, models, jobs, segmenter.warm_up)


def _evaluate_unseen(
    learned: Mapping[int, Mapping[str, Any]], evaluate: Callable[[Model], ModelResult], model: Model
) -> ModelResult:
    from segcore.learned.models import LearnedModels, using

    with using(LearnedModels.from_document(learned[model.number])):
        return evaluate(model)


def map_in_processes(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int, warm_up: Callable[[], None]
) -> list[Result]:
    """The function of every item, in their order, computed in ``jobs`` processes of one thread each.

    Raises
    ------
    BenchmarkError
        Where a process dies.
    """
    with one_thread_per_process():
        pool = ProcessPoolExecutor(
            jobs, mp_context=get_context("spawn"), initializer=_start_process, initargs=(warm_up,)
        )
        try:
            return _in_order(pool, function, items)
        except BrokenProcessPool as error:
            raise BenchmarkError("A process of the benchmark ended early: look for its message above.") from error
        finally:
            pool.shutdown(cancel_futures=True)


def _start_process(warm_up: Callable[[], None]) -> None:
    # Ctrl-C reaches all processes of a terminal: the first one ends the others, which have nothing to add.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warm_up()


def _in_order(pool: ProcessPoolExecutor, function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    futures = [pool.submit(function, item) for item in items]
    for done, future in enumerate(as_completed(futures), start=1):
        future.result()
        _show_progress(done, len(items))
    return [future.result() for future in futures]


def _show_progress(done: int, total: int) -> None:
    if sys.stderr.isatty():
        print(f"\r{done} of {total} models", end="\n" if done == total else "", file=sys.stderr, flush=True)


@contextmanager
def one_thread_per_process() -> Iterator[None]:
    """Processes that are started meanwhile have numerical libraries of one thread, unless the environment says more."""
    unset = [name for name in THREAD_SETTINGS if name not in os.environ]
    os.environ.update(dict.fromkeys(unset, "1"))
    try:
        yield
    finally:
        for name in unset:
            del os.environ[name]
