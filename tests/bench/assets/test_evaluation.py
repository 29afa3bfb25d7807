"""The evaluation of assets, their means and the printed table, with a segmenter of known levels."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.assets.dataset import read_assets
from bench.assets.evaluation import Agreement, AssetResult, evaluate_asset
from bench.assets.parallel import evaluate_assets
from bench.assets.report import render, save
from bench.assets.summary import by_set, over_sets
from bench.errors import BenchmarkError
from bench.learning.folds import Fold, read_folds, save_fold, with_unseen
from helpers.hierarchies import HeightSegmenter, ModelSegmenter
from segcore.learned.models import learned_models
from segcore.mesh import face_normals_and_areas


def result(collection: str, parts: int = 4, automatic: float = 0.2, segments: int = 4, **values: float) -> AssetResult:
    """A result with these values; the trivial methods have 0.3 and 0.25."""
    return replace(
        AssetResult(
            collection=collection,
            name="one",
            faces=12,
            parts=parts,
            given=Agreement(parts, 0.1, 0.9),
            automatic=Agreement(segments, automatic, 0.8),
            best_segments=parts,
            best=0.05,
            components=0.3,
            kmeans=0.25,
            flat=0.5,
            mirror=math.nan,
            repeats=2,
            unlike=1,
            cpu_s=1.0,
        ),
        **values,
    )


def test_the_levels_of_an_asset_are_compared_with_its_parts(assets: Path) -> None:
    bell = read_assets(assets)[1]
    mesh = bell.read_mesh()
    part = bell.read_parts(len(mesh.faces))
    area = face_normals_and_areas(mesh.corners)[1]
    lower, upper, neck = (area[part == i].sum() for i in range(3))
    found = evaluate_asset(bell, HeightSegmenter(), 0).result
    # The layers of a third of the height are not quite the balls and the neck, but the upper ball is in one of them.
    third = mesh.corners[:, :, 2].mean(axis=1) > mesh.vertices[:, 2].min() + 2 / 3 * np.ptp(mesh.vertices[:, 2])
    assert set(part[third].tolist()) == {1}
    missed = upper - area[third].sum()
    assert found.automatic.segments == 2
    pairs = lower * neck + (lower + neck) * missed + missed * area[third].sum()
    assert found.automatic.one_minus_rand == pytest.approx(2 * pairs / (lower + upper + neck) ** 2)
    assert (found.given.segments, found.best_segments, found.parts) == (3, 3, 3)
    assert found.best == pytest.approx(found.given.one_minus_rand)
    assert found.given.iou > found.automatic.iou
    # The whole surface is one component.
    pairs = lower * upper + lower * neck + upper * neck
    assert found.components == pytest.approx(2 * pairs / (lower + upper + neck) ** 2)
    assert (found.kmeans, found.faces, found.halved) == (0.25, len(mesh.faces), False)
    assert math.isnan(found.mirror)


def test_only_the_set_of_symmetric_bodies_has_a_mirror_image(assets: Path) -> None:
    bell = replace(read_assets(assets)[1], collection="bodies")
    assert evaluate_asset(bell, HeightSegmenter(), 0).result.mirror == 0.0


def test_sets_have_equal_weights_and_an_undefined_value_has_none() -> None:
    results = [result("a", automatic=0.1), result("a", automatic=0.3), result("b", automatic=0.6, mirror=0.2)]
    sets = by_set(results)
    assert [(one.collection, one.models, one.means.automatic) for one in sets] == [
        ("a", 2, pytest.approx(0.2)),
        ("b", 1, 0.6),
    ]
    mean = over_sets(sets)
    assert (mean.automatic, mean.mirror, mean.given_iou) == (pytest.approx(0.4), 0.2, 0.9)
    assert math.isnan(sets[0].means.mirror)


@pytest.mark.parametrize(("automatic", "worse"), [(0.254, False), (0.256, True)])
def test_a_set_is_worse_if_the_better_trivial_method_is_better_by_more_than_a_margin(
    automatic: float, worse: bool
) -> None:
    results = [result("a", automatic=automatic)]
    assert by_set(results)[0].means.worse_than_trivial == worse
    assert f"by more than 0.005: {int(worse)} of 1{': a' if worse else ''}." in render(results)


def test_half_of_the_parts_or_fewer_are_counted() -> None:
    results = [result("a", parts=5, segments=segments) for segments in (1, 2, 3)]
    assert by_set(results)[0].halved == 2
    assert "Half or fewer of the parts found: 2 of 3 models." in render(results)
    assert "Groups of congruent shells that are not cut alike: 3 of 6." in render(results)


def test_the_table_has_a_row_for_every_set_and_one_for_the_mean() -> None:
    lines = render([result("a", automatic=0.1), result("b", automatic=0.2)]).splitlines()
    rows = [line.split() for line in lines if line.startswith(("a ", "b ", "mean over sets"))]
    assert rows[0][:6] == ["a", "1", "4.0", "4.0", "0", "0.1000"]
    assert " ".join(rows[2][3:]) == "2 4.0 4.0 0 0.1000 0.1500 0.9000 0.8000 0.0500 0.3000 0.2500 0.5000 - 1.00"


def test_saved_results_have_null_for_an_undefined_value(tmp_path: Path) -> None:
    save(tmp_path / "a.json", [result("a")], {"seed": 3})
    document = json.loads((tmp_path / "a.json").read_text())
    assert (document["format"], document["seed"]) == ("cleave-assets-1", 3)
    assert document["mean"]["mirror"] is document["sets"][0]["means"]["mirror"] is document["models"][0]["mirror"]
    assert document["models"][0]["mirror"] is None
    assert document["models"][0]["automatic"] == {"segments": 4, "one_minus_rand": 0.2, "iou": 0.8}
    with pytest.raises(BenchmarkError, match="cannot be written"):
        save(tmp_path / "no" / "a.json", [result("a")], {})


def test_every_asset_gets_what_was_learned_without_it(assets: Path, tmp_path: Path) -> None:
    save_fold(tmp_path, Fold("Props", frozenset({7, "props/crate", 3}), learned_models()))
    save_fold(tmp_path, Fold("Robots", frozenset({"robots/bell"}), learned_models()))
    assert json.loads((tmp_path / "props.json").read_text())["left_out"] == [3, 7, "props/crate"]
    folds = read_folds(tmp_path)
    crate, bell = with_unseen(read_assets(assets), folds)
    assert crate[1] is folds[3] is folds[7]
    assert bell[1] is folds["robots/bell"] is not crate[1]
    assert bell[1] == learned_models().document()


def test_the_models_of_the_folds_are_in_use_during_the_segmentation(assets: Path) -> None:
    bell = read_assets(assets, sets=["robots"])
    folds = {"robots/bell": learned_models().document()}
    results = [evaluate_assets(bell, ModelSegmenter(), 0, 1, models)[0].result for models in (None, folds)]
    assert [result.automatic.segments for result in results] == [2, 3]


def test_an_asset_that_every_fold_has_seen_is_an_error(assets: Path) -> None:
    folds = {3: learned_models().document(), "props/crate": learned_models().document()}
    with pytest.raises(BenchmarkError, match=r"No fold leaves out model robots/bell \(1 of 2 models"):
        evaluate_assets(read_assets(assets), HeightSegmenter(), 0, 1, folds)
