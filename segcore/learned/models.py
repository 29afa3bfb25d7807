"""The learned models that ship with the package."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from segcore.learned.gaussian_process import GaussianProcess
from segcore.learned.logistic import LogisticModel
from segcore.learned.shipped import Shipped

_LOGISTIC = ("boundary", "split", "split_of_bodies")


@dataclass(frozen=True, slots=True, eq=False)
class LearnedModels:
    """The models that ``python -m bench train`` fits; see docs/explanation/learned-models.md."""

    boundary: LogisticModel  # probability of a cut along an edge, see segcore.affinity.boundary_features
    split: LogisticModel  # share of the pairs across a cut that people keep together, see segcore.cut.features
    split_of_bodies: LogisticModel  # the same on surfaces of several bodies
    order: GaussianProcess | None = None  # the same for the splits of a finished tree; None: as the models above say

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> "LearnedModels":
        """The inverse of ``document``."""
        boundary, split, of_bodies = (LogisticModel.from_document(document[name]) for name in _LOGISTIC)
        order = document.get("order")
        return cls(boundary, split, of_bodies, None if order is None else GaussianProcess.from_document(order))

    def document(self) -> dict[str, Any]:
        """The models as plain values for JSON."""
        logistic = {name: getattr(self, name).document() for name in _LOGISTIC}
        return {**logistic, "order": None if self.order is None else self.order.document()}


_SHIPPED = Shipped("models.json", LearnedModels.from_document)
learned_models = _SHIPPED.current
using = _SHIPPED.using
