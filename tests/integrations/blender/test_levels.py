"""Levels are those of Cleave, found from the tree and the finest labels."""

import io
import json

import numpy as np
import pytest

import segcore
from integrations.blender.errors import CleaveError
from integrations.blender.levels import Levels, levels_from
from segcore.hierarchy import Hierarchy
from segcore.io.labels import hierarchy_document, write_npy
from segcore.shapes import burr


@pytest.fixture(scope="module")
def hierarchy() -> Hierarchy:
    return segcore.segment(burr(3).mesh)


def finest(hierarchy: Hierarchy) -> bytes:
    target = io.BytesIO()
    write_npy(target, hierarchy.labels(hierarchy.max_segments))
    return target.getvalue()


@pytest.fixture(scope="module")
def levels(hierarchy: Hierarchy) -> Levels:
    document = json.loads(json.dumps(hierarchy_document(hierarchy)))
    return levels_from(document, finest(hierarchy), len(hierarchy.face_leaf))


def test_every_level_has_the_labels_of_the_hierarchy(hierarchy: Hierarchy, levels: Levels) -> None:
    assert (levels.most, levels.automatic) == (hierarchy.max_segments, hierarchy.automatic_segments)
    assert levels.most > 7
    for segments in range(1, levels.most + 1):
        assert np.array_equal(levels.labels(segments), hierarchy.labels(segments))


def test_granularities_are_those_of_the_hierarchy(hierarchy: Hierarchy, levels: Levels) -> None:
    for granularity in np.linspace(0.0, 1.0, 41).tolist():
        assert levels.segments_at(granularity) == hierarchy.segments_at(granularity)


def test_a_mesh_of_one_part_has_one_level() -> None:
    one = segcore.segment(segcore.shapes.icosphere(1), segcore.SegmentationParameters(max_segments=1))
    levels = levels_from(hierarchy_document(one), finest(one), 80)
    assert levels.most == 1
    assert levels.labels(1).tolist() == [0] * 80


def test_other_answers_are_refused(hierarchy: Hierarchy) -> None:
    document, labels = hierarchy_document(hierarchy), finest(hierarchy)
    faces = len(hierarchy.face_leaf)
    for broken, bytes_ in (({}, labels), (document, b"<html>"), (document, labels[:-4]), ({"nodes": []}, labels)):
        with pytest.raises(CleaveError, match="cannot be read"):
            levels_from(broken, bytes_, faces)
    with pytest.raises(CleaveError, match=f"{faces} faces, but the mesh has {faces + 1}"):
        levels_from(document, labels, faces + 1)
