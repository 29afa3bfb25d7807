"""Other methods of segmentation, run on the same models: what Cleave and the paper's method are compared with.

None of them is a part of Cleave or needed to run it. Each is a ``bench.peers.method.Method``.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from bench.peers.cgal import CgalSdf
from bench.peers.kmeans import KMeans
from bench.peers.method import Method
from bench.peers.vhacd import VHacd

# By the name for the command line; each is called with the folder in which it may keep what it builds.
PEERS: dict[str, Callable[[Path], Method]] = {
    KMeans.key: lambda _: KMeans(),
    CgalSdf.key: CgalSdf,
    VHacd.key: lambda _: VHacd(),
}
