"""Other segmentation methods, with which Cleave and the method of the paper are compared on the same models.

None of them is a part of Cleave or needed to run it. Each is a ``bench.peers.method.Method``.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from bench.peers.cgal import CgalSdf
from bench.peers.kmeans import KMeans
from bench.peers.method import Method
from bench.peers.vhacd import VHacd

# By the name on the command line; each is called with a folder in which it may keep files.
PEERS: dict[str, Callable[[Path], Method]] = {
    KMeans.key: lambda _: KMeans(),
    CgalSdf.key: CgalSdf,
    VHacd.key: lambda _: VHacd(),
}
