import json

import numpy as np
import pytest

from segcore import segment, shapes
from segcore.affinity import boundary_features as boundary_model
from segcore.cut import features as split_model
from segcore.learned.logistic import LogisticModel
from segcore.learned.models import LearnedModels, learned_models, using
from segcore.parameters import SegmentationParameters


def flat(names):
    return LogisticModel(names, np.zeros(len(names)), np.ones(len(names)), np.zeros(4 * len(names)), 0.0)


def test_the_models_that_ship_are_made_for_the_features_of_the_code():
    models = learned_models()
    assert models.boundary.names == boundary_model.FEATURES
    assert models.split.names == split_model.FEATURES


def test_a_document_is_the_whole_model():
    models = learned_models()
    again = LearnedModels.from_document(json.loads(json.dumps(models.document())))
    features = np.random.default_rng(0).normal(size=(50, len(boundary_model.FEATURES)))
    np.testing.assert_array_equal(again.boundary.probability(features), models.boundary.probability(features))
    assert again.document() == models.document()


def test_the_probability_is_the_logistic_function_of_the_basis():
    model = LogisticModel(("x",), np.array([1.0]), np.array([2.0]), np.array([1.0, 0.5, 2.0, 3.0]), -0.5)
    x = np.array([-9.0, 0.0, 1.0, 5.0, 1e9])
    z = np.clip((x - 1) / 2, -4, 4)
    score = z + 0.5 * z**2 + 2 * np.maximum(z - 1, 0) + 3 * np.maximum(-z - 1, 0) - 0.5
    np.testing.assert_allclose(model.probability(x[:, None]), 1 / (1 + np.exp(-score)))


def test_other_models_are_used_inside_and_only_there():
    shipped = learned_models()
    other = LearnedModels(flat(boundary_model.FEATURES), flat(split_model.FEATURES))
    with using(other):
        assert learned_models() is other
        # A rule that gains nothing by any split makes none of its own accord.
        assert segment(shapes.burr(4).mesh).automatic_segments == 1
    assert learned_models() is shipped
    assert segment(shapes.burr(4).mesh).automatic_segments == 7


@pytest.mark.parametrize("affinity", ["learned", "concavity"])
def test_the_arms_of_a_burr_are_its_parts_with_and_without_learning(affinity):
    shape = shapes.burr(4)
    hierarchy = segment(shape.mesh, SegmentationParameters(affinity=affinity))
    assert hierarchy.automatic_segments == len(set(shape.parts.tolist()))


def test_the_order_goes_with_the_affinity():
    assert SegmentationParameters().split_order == "learned"
    assert SegmentationParameters(affinity="concavity").split_order == "ncut"
    assert SegmentationParameters(order="ncc").split_order == "ncc"
