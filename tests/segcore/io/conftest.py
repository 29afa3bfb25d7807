"""A segmented shape for the tests of parts."""

import pytest

from segcore import shapes
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters


@pytest.fixture(scope="module")
def burr() -> tuple[Mesh, Hierarchy]:
    """A ball with six arms, segmented."""
    mesh = shapes.burr().mesh
    return mesh, segment(mesh, SegmentationParameters(max_segments=64))
