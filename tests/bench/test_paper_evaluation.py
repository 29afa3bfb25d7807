"""How the methods of the paper's evaluation are judged, kept and put into tables and charts."""

import os
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from bench.charts import PANELS, Bar, metric_chart
from bench.errors import BenchmarkError
from bench.paper.evaluation import MethodResults, evaluate_methods
from bench.paper.label_cache import LabelCache
from bench.paper.pictures import broad_view, matched, side_by_side
from bench.paper.processes import one_thread
from bench.paper.tables import PAPER_SECONDS, difference_table, metric_table, rank_table, ranks, time_table
from bench.peers.method import Method, Outcome, source_digest
from bench.pool import THREAD_SETTINGS
from bench.princeton.dataset import read_models
from bench.princeton.evaluation import evaluate_model
from bench.princeton.results import load_results, save_results
from bench.princeton.summary import overall
from helpers.paper_models import SHAPES, Slices, write_benchmark
from segcore.mesh import Mesh
from segcore.shapes import box


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_benchmark(tmp_path_factory.mktemp("benchmark"))


@pytest.fixture(scope="module")
def results(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, MethodResults]:
    """Slices, and the same giving up on the larger model."""
    faces = sorted(len(shape.mesh.faces) for _, shape, _ in SHAPES.values())
    methods: list[Method] = [Slices(), Slices("timid", most_faces=faces[0])]
    return evaluate_methods(read_models(folder), methods, LabelCache(tmp_path_factory.mktemp("cache")), jobs=2)


@dataclass(frozen=True)
class SlicesAtOnce:
    """The same slices as a segmenter of the princeton command."""

    max_segments: int = 100

    def warm_up(self) -> None:
        pass

    def __call__(self, mesh: Mesh, seed: int) -> "SlicesAtOnce":
        assert seed == 0
        return SlicesOf(mesh=mesh)


@dataclass(frozen=True)
class SlicesOf(SlicesAtOnce):
    mesh: Mesh | None = None

    def labels(self, segments: int | None = None) -> np.ndarray:
        assert self.mesh is not None
        return Slices().labels(self.mesh, segments)


def row_of(text: str, name: str) -> list[str]:
    return next(line for line in text.splitlines() if line.startswith(name)).removeprefix(name).split()


def test_a_method_scores_what_the_princeton_command_gives_it(folder: Path, results: dict[str, MethodResults]) -> None:
    for model, result in zip(read_models(folder), results["slices"].models, strict=True):
        expected = evaluate_model(model, SlicesAtOnce(), (0,), "given")
        assert (result.scores, result.people_scores) == (expected.scores, expected.people_scores)
        assert result.runs[0].segments == model.segments


def test_a_model_on_which_a_method_fails_counts_as_one_segment_and_is_named(results: dict[str, MethodResults]) -> None:
    timid = results["timid"]
    (failed,) = timid.failures
    assert {model.model: model.runs[0].segments for model in timid.models}[failed] == 1
    text = metric_table([results["slices"], timid])
    assert f"Timid failed on model {failed}: too many faces." in text
    assert "Timid: the cut discrepancy leaves out 1 of 2 models" in text
    assert (row_of(text, "Slices")[-2:], row_of(text, "Timid")[-2:]) == (["0", "0"], ["1", "1"])


def test_a_failure_has_no_time(results: dict[str, MethodResults]) -> None:
    assert (results["slices"].cpu_s, results["timid"].cpu_s) == ([0.5, 0.5], [0.5])


def test_results_can_be_compared_by_the_compare_command(results: dict[str, MethodResults], tmp_path: Path) -> None:
    for key, one in results.items():
        save_results(tmp_path / f"{key}.json", one.models, "given", {"settings": one.method.settings})
        assert load_results(tmp_path / f"{key}.json").scores.keys() == set(SHAPES)


@dataclass(frozen=True)
class CountedSlices(Slices):
    """Writes a line for every call."""

    log: Path = Path()

    def __call__(self, mesh: Mesh, segments: int) -> Outcome:
        with self.log.open("a") as file:
            file.write("called\n")
        return super().__call__(mesh, segments)

    @property
    def calls(self) -> int:
        return len(self.log.read_text().splitlines()) if self.log.exists() else 0


def test_a_segmentation_is_made_once_for_each_state_of_method_mesh_and_number(tmp_path: Path) -> None:
    cache, mesh = LabelCache(tmp_path / "cache"), box()
    method = CountedSlices(log=tmp_path / "log")
    first = cache.outcome(method, 1, mesh, 3)
    again = cache.outcome(method, 1, mesh, 3)
    assert method.calls == 1
    assert np.array_equal(first.labels, again.labels)
    assert (again.cpu_s, again.failure) == (first.cpu_s, first.failure)
    for changed, other_mesh, segments in (
        (replace(method, settings="2"), mesh, 3),
        (method, box((2, 1, 1)), 3),
        (method, mesh, 4),
    ):
        before = method.calls
        cache.outcome(changed, 1, other_mesh, segments)
        assert method.calls == before + 1


def test_a_failure_is_kept_too(tmp_path: Path) -> None:
    cache = LabelCache(tmp_path / "cache")
    method = CountedSlices(most_faces=1, log=tmp_path / "log")
    first, again = (cache.outcome(method, 1, box(), 3) for _ in range(2))
    assert first.failure == again.failure == "too many faces."
    assert not again.labels.any()
    assert method.calls == 1


def test_a_damaged_file_is_made_again(tmp_path: Path) -> None:
    cache = LabelCache(tmp_path / "cache")
    method = CountedSlices(log=tmp_path / "log")
    first = cache.outcome(method, 1, box(), 3)
    (path,) = (tmp_path / "cache").rglob("*.npz")
    whole = path.read_bytes()
    for damaged in (b"", whole[: len(whole) // 2], b"not a segmentation"):
        path.write_bytes(damaged)
        assert np.array_equal(cache.outcome(method, 1, box(), 3).labels, first.labels)
    assert method.calls == 4


def test_a_cache_that_cannot_be_written_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file")
    with pytest.raises(BenchmarkError, match="cannot be kept"):
        LabelCache(tmp_path / "cache").outcome(Slices(), 1, box(), 2)


def test_the_digest_of_sources_changes_with_any_of_them(tmp_path: Path) -> None:
    for name in ("a.py", "b.py", "notes.txt"):
        (tmp_path / name).write_text(name)
    before = source_digest(tmp_path)
    (tmp_path / "notes.txt").write_text("changed")
    assert source_digest(tmp_path) == before
    (tmp_path / "b.py").write_text("changed")
    assert source_digest(tmp_path) != before
    assert source_digest(tmp_path / "a.py") != source_digest(tmp_path / "b.py")


def test_processes_have_one_thread_and_the_environment_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(THREAD_SETTINGS[0], "7")
    monkeypatch.delenv(THREAD_SETTINGS[1], raising=False)
    with one_thread():
        assert [os.environ[name] for name in THREAD_SETTINGS] == ["1"] * len(THREAD_SETTINGS)
    assert os.environ[THREAD_SETTINGS[0]] == "7"
    assert THREAD_SETTINGS[1] not in os.environ


def test_equal_values_share_the_better_rank() -> None:
    assert ranks([0.3, 0.1, 0.3, 0.2]) == [3, 1, 3, 2]


def test_the_rank_table_ranks_by_category_and_over_all(results: dict[str, MethodResults]) -> None:
    slices, timid = results["slices"], results["timid"]
    text = rank_table([slices, timid])
    for name, models in (("Human", slice(0, 1)), ("Bearing", slice(1, 2)), ("All models", slice(0, 2))):
        values = [np.mean([model.scores.one_minus_rand for model in one.models[models]]) for one in (slices, timid)]
        count, rank_a, a, rank_b, b, _ = row_of(text, name)
        assert (int(count), a, b) == (len(slices.models[models]), f"{values[0]:.3f}", f"{values[1]:.3f}")
        assert [int(rank_a), int(rank_b)] == ranks(values)


def test_differences_are_those_of_the_second_to_the_first(results: dict[str, MethodResults]) -> None:
    slices, timid = results["slices"], results["timid"]
    a, b = (overall(one.models).scores.one_minus_rand for one in (slices, timid))
    cells = row_of(difference_table([(slices, timid)]), "Timid against Slices")
    assert cells[:3] == [f"{a:.4f}", f"{b:.4f}", f"{b - a:.4f}"]


def test_times_are_ratios_to_the_papers_method_here_and_there(results: dict[str, MethodResults]) -> None:
    unit = replace(results["slices"], method=Slices("inverse_power"))
    slow = replace(results["slices"], method=Slices("fiedler"))
    slower = [replace(model, runs=(replace(model.runs[0], cpu_s=1.5),)) for model in slow.models]
    text = time_table([unit, replace(slow, models=tuple(slower)), results["timid"]])
    assert row_of(text, "Inverse_power") == ["0.500", "0.500", "1.000", "69.0", "1.000", "138.0"]
    paper = PAPER_SECONDS["fiedler"]
    assert row_of(text, "Fiedler") == ["1.500", "1.500", "3.000", f"{paper}", f"{paper / 69:.3f}", f"{paper / 1.5:.1f}"]
    assert row_of(text, "Timid") == ["0.500", "0.500", "1.000", "-", "-", "-"]


def test_the_chart_shows_every_value_and_the_peoples(results: dict[str, MethodResults]) -> None:
    slices, timid = (overall(one.models) for one in results.values())
    bars = [Bar("Slices", slices.scores, 0), Bar("Timid", timid.scores, 1)]
    figure = metric_chart("Two methods", bars, slices.people_scores)
    for axes, (heading, metrics) in zip(figure.axes, PANELS, strict=True):
        names = [name for name, _ in metrics]
        assert axes.get_title(loc="left") == heading
        widths = [bar.get_width() for container in axes.containers for bar in container]
        assert widths == [getattr(bar.scores, name) for name in names for bar in bars]
        lines = [line.get_xdata()[0] for line in axes.lines]
        assert lines == [getattr(slices.people_scores, name) for name in names]
        assert axes.get_xlim()[0] == 0
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["Slices", "Timid"]


def test_matched_labels_are_the_same_segments_with_the_colours_of_the_reference() -> None:
    reference = np.array([0, 0, 0, 1, 1, 1, 2, 2], dtype=np.int32)
    labels = np.array([2, 2, 3, 3, 1, 1, 1, 0], dtype=np.int32)
    renamed = matched(labels, reference)
    assert len(np.unique(np.stack([labels, renamed]), axis=1).T) == len(np.unique(labels)) == len(np.unique(renamed))
    assert renamed.tolist() == [0, 0, 3, 3, 1, 1, 1, 2]


def test_a_shape_is_seen_from_where_it_is_broad() -> None:
    for size in ((4.0, 3.0, 1.0), (1.0, 3.0, 4.0), (4.0, 1.0, 3.0)):
        azimuth, elevation = np.radians(broad_view(box(size)))
        towards = [np.sin(azimuth) * np.cos(elevation), np.sin(elevation), np.cos(azimuth) * np.cos(elevation)]
        assert np.argmax(np.abs(towards)) == np.argmin(size)


def test_drawings_stand_side_by_side_on_white() -> None:
    labels = np.zeros(12, dtype=np.int32)
    pixels = side_by_side(box(), [labels, labels])
    height, width, channels = pixels.shape
    assert (width, channels) == (2 * height, 4)
    assert np.array_equal(pixels[:, :height], pixels[:, height:])
    assert pixels[0, 0].tolist() == [255] * 4
    assert (pixels[..., 3] == 255).all()
