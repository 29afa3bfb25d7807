"""The authored assets as a folder: meshes, and the part of every face."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from bench.datasets import read_labels, read_mesh, read_table, spread_evenly
from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from segcore.arrays import LongArray
    from segcore.mesh import Mesh

NO_PART = -1  # label of the faces that belong to no part


@dataclass(frozen=True, slots=True)
class Asset:
    """One mesh in the vertices of its author: the paths of its files, and its number of parts."""

    collection: str  # column set of models.tsv: robots, people, ...
    name: str
    parts: int
    kmeans: float  # 1 - Rand of k-means of the face centroids with the true number, from models.tsv
    mesh_path: Path  # SET/NAME.ply
    parts_path: Path  # SET/NAME.seg

    @property
    def key(self) -> str:
        """SET/NAME, the name of the asset in files and messages."""
        return f"{self.collection}/{self.name}"

    def read_mesh(self) -> Mesh:
        """Read the mesh of the asset.

        Raises
        ------
        BenchmarkError
            If the file is missing or cannot be read.
        """
        return read_mesh(self.mesh_path, self.key)

    def read_parts(self, face_count: int) -> LongArray:
        """(F,) part of every face, NO_PART if it belongs to none.

        Raises
        ------
        BenchmarkError
            If the file is not a list of ``face_count`` integers.
        """
        return read_labels(self.parts_path, face_count)


def read_assets(folder: Path, limit: int | None = None, sets: Sequence[str] | None = None) -> list[Asset]:
    """Read the list of assets ``folder``/models.tsv, in its order.

    Parameters
    ----------
    folder : contains models.tsv (columns set, name, parts, kmeans_1rand and others), SET/NAME.ply and
        SET/NAME.seg.
    limit : return at most this many assets, spread evenly over the list and so over the sets.
    sets : only the assets of these sets; None for all.

    Raises
    ------
    BenchmarkError
        If the list is missing, empty or malformed, a set has no asset, or the limit is below 1.
    """
    listed = _listed_assets(folder)
    if sets is None:
        return spread_evenly(listed, limit)
    present = {asset.collection for asset in listed}
    missing = [name for name in sets if name not in present]
    if missing:
        raise BenchmarkError(f"There is no set {missing[0]!r} in {folder}: there are {', '.join(sorted(present))}.")
    return spread_evenly([asset for asset in listed if asset.collection in sets], limit)


def _listed_assets(folder: Path) -> list[Asset]:
    return read_table(folder / "models.tsv", "assets", "set, name, parts, kmeans_1rand", partial(_asset, folder))


def _asset(folder: Path, row: dict[str, str]) -> Asset:
    collection, name = row["set"], row["name"]
    return Asset(
        collection=collection,
        name=name,
        parts=int(row["parts"]),
        kmeans=float(row["kmeans_1rand"]),
        mesh_path=folder / collection / f"{name}.ply",
        parts_path=folder / collection / f"{name}.seg",
    )
