"""Open edges agree with those that plain Python finds."""

from collections import Counter

import numpy as np
import pytest

from segcore import shapes
from segcore.clean.borders import ends_of, open_edges
from segcore.clean.topology import dual_edges


@pytest.mark.parametrize("kept", [320, 300, 200])
def test_open_edges_have_one_face(kept: int) -> None:
    faces = np.concatenate([shapes.icosphere(2).faces[:kept], [[0, 50, 100]]]).astype(np.int32)
    uses = Counter(frozenset((int(f[k]), int(f[k - 1]))) for f in faces for k in range(3))
    borders = open_edges(faces, dual_edges(faces, 162))
    found = [frozenset(ends) for ends in ends_of(borders, faces).tolist()]
    assert sorted(map(sorted, found)) == sorted(sorted(edge) for edge, count in uses.items() if count == 1)


def test_a_closed_surface_has_no_open_edges() -> None:
    faces = shapes.icosphere(2).faces
    assert len(open_edges(faces, dual_edges(faces, 162))) == 0
