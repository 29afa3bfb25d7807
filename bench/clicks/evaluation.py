"""Clicks on all parts of one model."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bench.assets.dataset import Asset
from bench.clicks.person import Shape
from bench.clicks.selectors import GuideSelector, RegionGrowing, Selector
from bench.errors import BenchmarkError
from bench.princeton.dataset import Model
from bench.segmenter import CleaveSegmenter

if TYPE_CHECKING:
    from segcore.arrays import BoolArray, LongArray
    from segcore.hierarchy import Hierarchy

MOST_CLICKS = 10
ENOUGH = 0.90  # the IoU that counts as right


@dataclass(frozen=True, slots=True)
class Clicks:
    """What happened for one part."""

    iou: tuple[float, ...]  # after 1, 2, ..., MOST_CLICKS clicks; 1 from the click on after which nothing is wrong
    cpu_ms: tuple[float, ...]  # of the clicks that were made

    @property
    def until_enough(self) -> int:
        """Clicks until the IoU is 0.90; MOST_CLICKS if it never is."""
        return next((count for count, iou in enumerate(self.iou, start=1) if iou >= ENOUGH), MOST_CLICKS)


@dataclass(frozen=True, slots=True)
class ClickResult:
    """All parts of one model."""

    key: int | str
    group: str  # category or set
    faces: int
    guide_cpu_s: float  # of making the guide
    guided: list[Clicks]
    growing: list[Clicks]
    best_node: list[float]  # the largest IoU of a node of the hierarchy


def group_of(model: Model | Asset) -> str:
    """The category of a model of the benchmark, the set of an asset."""
    return model.category if isinstance(model, Model) else model.collection


def segmentations_of(model: Model | Asset, face_count: int, people: int | None) -> list[LongArray]:
    """The segmentations of the first ``people`` people, or the one of the author."""
    if isinstance(model, Asset):
        return [model.read_parts(face_count)]
    return model.read_people(face_count)[:people]


def evaluate_clicks(model: Model | Asset, segmenter: CleaveSegmenter, people: int | None) -> ClickResult:
    """Click on all parts of all people of a model.

    Raises
    ------
    BenchmarkError
        If the model cannot be read or segmented, or a mark is not obeyed.
    """
    from segcore.clean.surface import build_surface
    from segcore.edit.guide import Guide

    mesh = model.read_mesh()
    hierarchy = segmenter(mesh, 0)
    surface = build_surface(mesh)
    shape = Shape.of(mesh, surface)
    began = time.process_time()
    guide = Guide(mesh, hierarchy, surface)
    guide_s = time.process_time() - began
    select = GuideSelector(guide, shape)
    grow = RegionGrowing(shape, 1.0 / hierarchy.automatic_segments)
    result = ClickResult(model.key, group_of(model), len(mesh.faces), guide_s, [], [], [])
    for labels in segmentations_of(model, len(mesh.faces), people):
        for wanted in shape.wanted_parts(labels):
            result.guided.append(click(shape, select, wanted))
            result.growing.append(click(shape, grow, wanted))
            result.best_node.append(_best_node(hierarchy, shape, wanted))
    return result


def click(shape: Shape, select: Selector, wanted: BoolArray) -> Clicks:
    """Mark faces until the part is right, or ``MOST_CLICKS`` times.

    Raises
    ------
    BenchmarkError
        If a mark is not obeyed.
    """
    marked: int | None = shape.middle(wanted)
    inside: list[int] = []
    outside: list[int] = []
    ious: list[float] = []
    times: list[float] = []
    while marked is not None and len(ious) < MOST_CLICKS:
        (inside if wanted[marked] else outside).append(marked)
        began = time.process_time()
        found = select(inside, outside)
        times.append(1e3 * (time.process_time() - began))
        if not found[inside].all() or (outside and found[outside].any()):
            raise BenchmarkError(f"The marks inside {inside} and outside {outside} are not obeyed.")
        ious.append(shape.iou(found, wanted))
        marked = shape.next_click(found, wanted)
    ious += [1.0] * (MOST_CLICKS - len(ious))
    return Clicks(tuple(ious), tuple(times))


def _best_node(hierarchy: Hierarchy, shape: Shape, wanted: BoolArray) -> float:
    leaf = hierarchy.face_leaf[shape.input_face]
    own, shared = (np.bincount(leaf, values, hierarchy.node_count) for values in (shape.area, shape.area * wanted))
    for split in reversed(range(len(hierarchy.split_node))):
        for sums in (own, shared):
            sums[hierarchy.split_node[split]] += sums[2 * split + 1] + sums[2 * split + 2]
    return float((shared / (own + shape.area[wanted].sum() - shared)).max())
