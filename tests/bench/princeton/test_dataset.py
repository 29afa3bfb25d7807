"""The folder of the benchmark: its list of models and its files."""

from pathlib import Path

import pytest

from bench.errors import BenchmarkError
from bench.princeton.dataset import find_models, read_models
from helpers.bench.strips import STRIP_COLUMNS


def test_a_limit_spreads_the_models_over_the_whole_list(strips: Path) -> None:
    assert [model.number for model in read_models(strips, 2)] == [1, 3]
    assert [model.number for model in read_models(strips, 99)] == [1, 3, 21]
    rows = "".join(f"{number}\tAny\t2\n" for number in range(1, 11))
    (strips / "segments.tsv").write_text("model\tcategory\tsegments\n" + rows)
    assert [model.number for model in read_models(strips, 5)] == [1, 3, 5, 7, 9]


def test_models_are_found_by_their_numbers(strips: Path) -> None:
    assert [model.number for model in find_models(strips, [21, 1])] == [21, 1]
    with pytest.raises(BenchmarkError, match="There is no model 2 in"):
        find_models(strips, [1, 2])


def test_an_error_names_the_file_that_does_not_fit(strips: Path) -> None:
    model = read_models(strips)[0]
    path = model.people_folder / "1_0.seg"
    for content, message in [("0\n1\n", "each of 24 faces, not 2"), ("a\n", "not a list of integers"), ("", "not 0")]:
        path.write_text(content)
        with pytest.raises(BenchmarkError, match=message):
            model.read_people(2 * STRIP_COLUMNS)
    model.mesh_path.unlink()
    with pytest.raises(BenchmarkError, match="Model 1 cannot be read"):
        model.read_mesh()
    (strips / "segments.tsv").write_text("model\tkind\n1\tRod\n")
    with pytest.raises(BenchmarkError, match="columns model, category, segments"):
        read_models(strips)
