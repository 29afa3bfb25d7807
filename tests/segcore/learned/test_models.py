import json

import numpy as np
import pytest

from segcore import segment, shapes
from segcore.affinity.boundary_features import FEATURES as BOUNDARY_FEATURES
from segcore.cut.features import FEATURES as SPLIT_FEATURES
from segcore.cut.features import CutFeatures
from segcore.cut.rules import ORDER_FEATURES
from segcore.learned.logistic import LogisticModel
from segcore.learned.models import LearnedModels, learned_models, using
from segcore.parameters import SegmentationParameters


def flat(names, bias=0.0):
    """A model with the same probability for all features, 1/2 by default."""
    return LogisticModel(names, np.zeros(len(names)), np.ones(len(names)), np.zeros(4 * len(names)), bias)


def test_the_shipped_models_have_the_features_of_the_code():
    models = learned_models()
    assert models.boundary.names == BOUNDARY_FEATURES
    assert models.split.names == CutFeatures._fields
    assert set(models.split_of_bodies.names) < set(SPLIT_FEATURES)
    assert models.order.names == ORDER_FEATURES


def test_a_document_contains_the_whole_model():
    models = learned_models()
    again = LearnedModels.from_document(json.loads(json.dumps(models.document())))
    features = np.random.default_rng(0).normal(size=(50, len(BOUNDARY_FEATURES)))
    np.testing.assert_array_equal(again.boundary.probability(features), models.boundary.probability(features))
    assert again.document() == models.document()


def test_the_probability_is_the_logistic_function_of_the_basis():
    model = LogisticModel(("x",), np.array([1.0]), np.array([2.0]), np.array([1.0, 0.5, 2.0, 3.0]), -0.5)
    x = np.array([-9.0, 0.0, 1.0, 5.0, 1e9])
    z = np.clip((x - 1) / 2, -4, 4)
    score = z + 0.5 * z**2 + 2 * np.maximum(z - 1, 0) + 3 * np.maximum(-z - 1, 0) - 0.5
    np.testing.assert_allclose(model.probability(x[:, None]), 1 / (1 + np.exp(-score)))


def test_other_models_are_used_inside_the_context_only():
    shipped = learned_models()
    kept = flat(SPLIT_FEATURES, bias=1.0)
    other = LearnedModels(flat(BOUNDARY_FEATURES), kept, kept)
    with using(other):
        assert learned_models() is other
        # If people keep 73 % of the pairs across every cut together, the automatic number is one.
        assert segment(shapes.burr(4).mesh).automatic_segments == 1
    assert learned_models() is shipped
    assert segment(shapes.burr(4).mesh).automatic_segments == 7


@pytest.mark.parametrize("affinity", ["learned", "concavity"])
def test_the_parts_of_a_burr_are_found_with_and_without_learning(affinity):
    shape = shapes.burr(4)
    hierarchy = segment(shape.mesh, SegmentationParameters(affinity=affinity))
    assert hierarchy.automatic_segments == len(set(shape.parts.tolist()))


def test_the_order_is_learned_only_if_the_affinity_is():
    assert SegmentationParameters().split_order == "learned"
    assert SegmentationParameters(affinity="concavity").split_order == "ncut"
    assert SegmentationParameters(order="ncc").split_order == "ncc"
