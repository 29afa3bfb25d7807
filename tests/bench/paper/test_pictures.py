"""The drawings of segmentations."""

import numpy as np

from bench.paper.pictures import broad_view, matched, side_by_side
from segcore.shapes import box


def test_matched_labels_are_the_same_segments_with_the_colours_of_the_reference() -> None:
    reference = np.array([0, 0, 0, 1, 1, 1, 2, 2], dtype=np.int32)
    labels = np.array([2, 2, 3, 3, 1, 1, 1, 0], dtype=np.int32)
    renamed = matched(labels, reference)
    assert len(np.unique(np.stack([labels, renamed]), axis=1).T) == len(np.unique(labels)) == len(np.unique(renamed))
    assert renamed.tolist() == [0, 0, 3, 3, 1, 1, 1, 2]


def test_the_view_is_along_the_thinnest_direction() -> None:
    for size in ((4.0, 3.0, 1.0), (1.0, 3.0, 4.0), (4.0, 1.0, 3.0)):
        azimuth, elevation = np.radians(broad_view(box(size)))
        towards = [np.sin(azimuth) * np.cos(elevation), np.sin(elevation), np.cos(azimuth) * np.cos(elevation)]
        assert np.argmax(np.abs(towards)) == np.argmin(size)


def test_drawings_are_side_by_side_on_white() -> None:
    labels = np.zeros(12, dtype=np.int32)
    pixels = side_by_side(box(), [labels, labels])
    height, width, channels = pixels.shape
    assert (width, channels) == (2 * height, 4)
    assert np.array_equal(pixels[:, :height], pixels[:, height:])
    assert pixels[0, 0].tolist() == [255] * 4
    assert (pixels[..., 3] == 255).all()
