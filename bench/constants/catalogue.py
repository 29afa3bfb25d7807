"""The constants whose neighbours are measured."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module


@dataclass(frozen=True, slots=True)
class Constant:
    """A constant of a module, with the values that it is given."""

    module: str
    name: str
    values: tuple[float, ...]  # the value in force and its neighbours
    importers: tuple[str, ...] = ()  # other modules with a name for it
    parameters: Mapping[str, object] = field(default_factory=dict)  # of the segmentation
    solver: str = ""  # whose cuts are measured, for constants of solvers

    @property
    def value(self) -> float:
        """The value in force."""
        value: float = getattr(import_module(self.module), self.name)
        return value

    @contextmanager
    def set_to(self, value: float) -> Iterator[None]:
        """Give the constant another value meanwhile. Compiled kernels must not use it."""
        modules = [import_module(name) for name in (self.module, *self.importers)]
        before = self.value
        try:
            for module in modules:
                setattr(module, self.name, value)
            yield
        finally:
            for module in modules:
                setattr(module, self.name, before)


RULES, BOUNDARY = "segcore.cut.rules", "segcore.label.boundary"
FLOW, VARIATION, BREGMAN = (f"segcore.solvers.{name}" for name in ("flow", "total_variation", "split_bregman"))
POWER, LAPLACIAN = "segcore.solvers.inverse_power", "segcore.solvers.p_laplacian"

# Judged by the segmentations.
OF_SEGMENTATIONS = (
    Constant(RULES, "AUTOMATIC_NCUT", (1.2, 1.32, 1.44, 1.58, 1.74), parameters={"affinity": "concavity"}),
    Constant(RULES, "SMALLEST_SIDE", (0.0, 0.001, 0.002, 0.004)),
    Constant(RULES, "NCUT_WEIGHT", (0.0, 0.2, 0.4, 0.8)),
    Constant(BOUNDARY, "BAND", (0.015, 0.03, 0.06)),
    Constant(BOUNDARY, "STIFFNESS", (0.03, 0.1, 0.3)),
)

# Judged by the cuts of reference graphs.
OF_SOLVERS = (
    Constant("segcore.solvers.fiedler", "TOLERANCE", (1e-4, 1e-5, 1e-6), solver="fiedler"),
    Constant("segcore.solvers.fiedler", "CHECK_EVERY", (1, 3, 6), solver="fiedler"),
    Constant(FLOW, "STEPS", (2, 4, 8), solver="flow"),
    Constant(FLOW, "ITERATIONS", (2, 5, 10), solver="flow"),
    Constant(FLOW, "WORST_IMPROVED", (1.0, 1.35, 2.0), solver="flow"),
    Constant(VARIATION, "TIME_STEP", (10.0, 30.0, 100.0), solver="flow"),
    Constant(VARIATION, "FIRST_THRESHOLD", (0.1, 0.3, 1.0), solver="flow"),
    Constant(VARIATION, "TIME_STEP", (10.0, 30.0, 100.0), solver="split_bregman"),
    Constant(VARIATION, "FIRST_THRESHOLD", (0.1, 0.3, 1.0), solver="split_bregman"),
    Constant(BREGMAN, "ITERATIONS_PER_STEP", (5, 10, 20), solver="split_bregman"),
    Constant(BREGMAN, "STEPS_WITHOUT_GAIN", (2, 5, 10), solver="split_bregman"),
    Constant(POWER, "FIRST_ITERATIONS", (25, 50, 100), solver="inverse_power"),
    Constant(POWER, "WORTHWHILE_GAIN", (0.005, 0.02, 0.08), solver="inverse_power"),
    Constant("segcore.solvers.starts", "SMOOTHING_STEPS", (1, 2, 4), solver="inverse_power"),
    Constant(LAPLACIAN, "CONTINUATION", (0.5, 0.7, 0.85), solver="p_laplacian"),
    Constant(LAPLACIAN, "LEAST_DECREASE", (1e-5, 1e-6, 1e-7), solver="p_laplacian"),
)
