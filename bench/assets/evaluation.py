"""Evaluates one asset: the segmentations of one hierarchy against the authored parts, and two trivial methods."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bench.assets.dataset import Asset
from bench.assets.metrics import Reference, mean_iou, one_minus_rand, rand_of_levels
from bench.assets.sheet import draw_tile, upright
from bench.errors import BenchmarkError
from bench.segmenter import CleaveSegmenter

if TYPE_CHECKING:
    from bench.paper.pictures import Pixels
    from segcore.arrays import IntArray
    from segcore.hierarchy import Hierarchy
    from segcore.mesh import Mesh

SYMMETRIC = frozenset({"bodies"})  # the sets whose meshes are mirror-symmetric


@dataclass(frozen=True, slots=True)
class Agreement:
    """A segmentation against the authored parts."""

    segments: int
    one_minus_rand: float
    iou: float  # mean over the parts, after matching

    @classmethod
    def of(cls, reference: Reference, label: IntArray) -> Agreement:
        shared = reference.shared_areas(label)
        return cls(len(shared), one_minus_rand(shared), mean_iou(shared))


@dataclass(frozen=True, slots=True)
class AssetResult:
    """The measurements on one asset."""

    collection: str
    name: str
    faces: int
    parts: int
    given: Agreement  # at the number of parts, or at the last level if there are fewer
    automatic: Agreement
    best_segments: int  # the level with the least 1 - Rand, the coarsest of equal ones
    best: float  # its 1 - Rand
    components: float  # 1 - Rand of the connected components
    kmeans: float  # 1 - Rand of k-means of the face centroids with the true number
    flat: float  # share of the automatic cut's length inside flat faces
    mirror: float  # 1 - Rand of the automatic labels against their mirror image; nan if the set is not symmetric
    repeats: int  # groups of congruent shells
    unlike: int  # such groups of which not all shells are cut alike
    cpu_s: float  # CPU time of the segmentation alone, all threads of the process

    @property
    def halved(self) -> bool:
        """Whether the automatic number is half of the true one or less."""
        return 2 * self.automatic.segments <= self.parts


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """The measurements on one asset, and a picture of it."""

    result: AssetResult
    pixels: Pixels | None  # (H, 2 H, 4) from draw_tile; None if no picture was asked for


def evaluate_asset(asset: Asset, segmenter: CleaveSegmenter, seed: int, drawn: bool = False) -> Evaluation:
    """Segment an asset once and measure the result.

    Parameters
    ----------
    drawn : also draw the automatic segments beside the parts.

    Raises
    ------
    BenchmarkError
        If a file of the asset cannot be used, or the segmentation fails.
    """
    from segcore.mesh import face_normals_and_areas

    mesh = asset.read_mesh()
    reference = Reference(asset.read_parts(len(mesh.faces)), face_normals_and_areas(mesh.corners)[1])
    start = time.process_time()
    try:
        hierarchy = segmenter(mesh, seed)
    except BenchmarkError as error:
        raise BenchmarkError(f"Model {asset.key}: {error}") from error
    cpu_s = time.process_time() - start
    pixels = draw_tile(upright(asset, mesh), hierarchy.labels(), reference.part) if drawn else None
    return Evaluation(_measured(asset, mesh, reference, hierarchy, cpu_s), pixels)


def _measured(asset: Asset, mesh: Mesh, reference: Reference, hierarchy: Hierarchy, cpu_s: float) -> AssetResult:
    # Imported here so that the other commands do not load the compiled kernels.
    from bench.assets.repeats import repeats_of
    from bench.assets.shape import component_labels, flat_share, mirror_disagreement
    from segcore.clean.surface import build_surface

    levels = rand_of_levels(hierarchy, reference)
    automatic = hierarchy.labels()
    surface = build_surface(mesh)
    centres = mesh.corners.mean(axis=1)
    shell = component_labels(surface)
    repeats = repeats_of(mesh, reference.area, shell, automatic)
    symmetric = asset.collection in SYMMETRIC
    return AssetResult(
        collection=asset.collection,
        name=asset.name,
        faces=len(mesh.faces),
        parts=asset.parts,
        given=Agreement.of(reference, hierarchy.labels(min(asset.parts, hierarchy.max_segments))),
        automatic=Agreement.of(reference, automatic),
        best_segments=int(np.argmin(levels)) + 1,
        best=float(levels.min()),
        components=one_minus_rand(reference.shared_areas(shell)),
        kmeans=asset.kmeans,
        flat=flat_share(surface, automatic),
        mirror=mirror_disagreement(centres, reference.area, automatic) if symmetric else math.nan,
        repeats=repeats.groups,
        unlike=repeats.unlike,
        cpu_s=cpu_s,
    )
