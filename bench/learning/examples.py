"""The meshes that are learned from: those of the benchmark, and authored assets."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING
from zlib import crc32

from bench.assets.dataset import Asset

if TYPE_CHECKING:
    from bench.princeton.dataset import Model
    from segcore.arrays import LongArray
    from segcore.mesh import Mesh

# Models of the benchmark that a set of assets counts as much as, whatever its size. Set by hand: with 24 the results on
# the benchmark are 0.003 worse.
SET_WEIGHT = 2.5


@dataclass(frozen=True, slots=True)
class Example:
    """One mesh with the segmentations of people or of its author."""

    source: Model | Asset
    weight: float  # of the mesh among all

    @property
    def key(self) -> int | str:
        """The number of a model of the benchmark, SET/NAME of an asset."""
        return self.source.key

    @property
    def is_asset(self) -> bool:
        """Whether the mesh is an authored asset, not a model of the benchmark."""
        return isinstance(self.source, Asset)

    @property
    def group(self) -> str:
        """The category of a model, the set of an asset."""
        return self.source.collection if isinstance(self.source, Asset) else self.source.category

    @property
    def seed(self) -> int:
        """A number that differs between meshes."""
        return self.source.number if not isinstance(self.source, Asset) else crc32(self.source.key.encode())

    def read_mesh(self) -> Mesh:
        """Read the mesh.

        Raises
        ------
        BenchmarkError
            If the file is missing or cannot be read.
        """
        return self.source.read_mesh()

    def read_people(self, face_count: int) -> list[LongArray]:
        """Read the segmentations (F,) of all people, or that of the author, with -1 for faces of no part.

        Raises
        ------
        BenchmarkError
            If there is none, or one is not a list of ``face_count`` integers.
        """
        if isinstance(self.source, Asset):
            return [self.source.read_parts(face_count)]
        return self.source.read_people(face_count)


def examples(models: Sequence[Model], assets: Sequence[Asset]) -> list[Example]:
    """Return the examples of both data sets: every model counts 1, every set of assets ``SET_WEIGHT``."""
    size = Counter(asset.collection for asset in assets)
    return [
        *(Example(model, 1.0) for model in models),
        *(Example(asset, SET_WEIGHT / size[asset.collection]) for asset in assets),
    ]
