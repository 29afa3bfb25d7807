"""WRITERS: what holds for every output format."""

import pytest
from hypothesis import given, settings

from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.written import written
from segcore.errors import InvalidParameters, UnsupportedFormat
from segcore.hierarchy import Hierarchy
from segcore.io import WRITE_OPTIONS, WRITERS, with_coordinates, writer_for
from segcore.mesh import Mesh

Segmented = tuple[Mesh, Hierarchy, int]


@pytest.mark.parametrize("kind", WRITERS)
def test_a_wrong_number_of_segments_is_refused_before_anything_is_written(kind: str) -> None:
    if kind == "cleave":
        pytest.skip("this file holds every level")
    for segments in (0, 4):
        with pytest.raises(InvalidParameters, match="1 to 3"):
            written(kind, *two_strips(), segments)


@given(segmentations())
@settings(max_examples=10)
def test_the_same_input_gives_the_same_bytes(segmented: Segmented) -> None:
    for kind in WRITERS:
        assert written(kind, *segmented) == written(kind, *segmented)


def test_a_writer_is_found_by_the_name_of_the_file() -> None:
    for kind, writer in WRITERS.items():
        assert writer_for(f"a.b{writer.extension.upper()}") is WRITERS[kind]
    with pytest.raises(UnsupportedFormat, match=r"\.dae.*\.glb, \.ply"):
        writer_for("hand.dae")


@pytest.mark.parametrize("kind", WRITERS)
def test_a_writer_takes_the_options_that_it_lists_and_no_others(kind: str) -> None:
    values = {
        "names": {0: "wheel"},
        "part_colors": {0: "#102030"},
        "all_levels": True,
        "features": True,
        "capped": True,
        "part_format": "obj",
        "layout": "flat",
        "keep": None,
        "colors": "faces",
        "unit": "mm",
        "up": "z",
        "edited": None,
    }
    assert set(values) == set(WRITE_OPTIONS)
    mesh, hierarchy = two_strips()
    segmented = with_coordinates(mesh, "inch", "y"), hierarchy
    for option, value in values.items():
        if option in WRITERS[kind].options:
            assert written(kind, *segmented, **{option: value})
        else:
            with pytest.raises(TypeError):
                written(kind, *segmented, **{option: value})
