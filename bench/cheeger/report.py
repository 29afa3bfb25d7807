"""The tables of the solvers."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from bench.cheeger.measurements import Measurement, Row
from bench.cheeger.references import Reference
from bench.text import format_table

# A cut within this factor of the best value counts as found; set by hand. bench/RESULTS.md shows how often that is so.
WITHIN = 1.005
# Rounding errors that do not count when two cuts are compared.
_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class Demand:
    """The requirement on a solver, set by hand: a cut within a factor of a reference, in a share of its time."""

    solver: str
    column: str  # of reference.tsv
    factor: float  # of the value in this column
    share: int  # 1 / share of the time of the reference code

    def known(self, reference: Reference) -> float:
        """Return the value in the column."""
        return reference.best_known if self.column == "ncc_best_known" else reference.six_starts


DEMANDS = (
    Demand("flow", "ncc_best_known", factor=WITHIN, share=20),
    Demand("inverse_power", "runs5_mean20", factor=1.01, share=10),
)


def render_references(references: Sequence[Reference], measured: Sequence[Row]) -> str:
    """Return a line for every graph, the means, and the number of graphs on which the demands are met."""
    best = [
        min(reference.best_known, *(result.ncc for result in row.values()))
        for reference, row in zip(references, measured, strict=True)
    ]
    solvers = list(measured[0])
    header = ["graph", "nodes", *(f"{solver}: cut" for solver in solvers), *(f"{solver}: ms" for solver in solvers)]
    rows = [
        [reference.name, str(reference.graph.node_count), *_ratios(row, value), *_milliseconds(row)]
        for reference, row, value in zip(references, measured, best, strict=True)
    ]
    lines = [format_table(header, [*rows, *_summary(solvers, measured, best)], rules=[len(rows)]), ""]
    lines += [_demand_line(demand, references, measured) for demand in DEMANDS if demand.solver in solvers]
    return "\n".join(lines)


def render_first_cuts(cuts: dict[str, list[Row]], models: Sequence[str]) -> str:
    """Return the means over the first cuts of models, and a line for every cut of a solver that is worse than p = 2.

    Parameters
    ----------
    cuts : one row for every model, by the kind of graph.
    models : names of the models.
    """
    tables = []
    for kind, measured in cuts.items():
        solvers = list(measured[0])
        best = [min(result.ncc for result in row.values()) for row in measured]
        header = [
            f"first cuts, {kind}",
            *(f"{solver}: cut" for solver in solvers),
            *(f"{solver}: ms" for solver in solvers),
        ]
        tables.append(format_table(header, [[row[0], *row[2:]] for row in _summary(solvers, measured, best)]))
    notes = [
        f"model {model}, {kind}: {note}"
        for i, model in enumerate(models)
        for kind, measured in cuts.items()
        for note in _failings(measured[i])
    ]
    return "\n\n".join([*tables, "\n".join(notes) or "No solver for p < 2 is worse than p = 2 on any first cut."])


def _failings(row: Row) -> list[str]:
    """Return a line for every solver for p < 2 whose cut is worse than that of p = 2, with which it starts."""
    if "fiedler" not in row:
        return []
    limit = row["fiedler"].ncc * (1 + _ROUNDING)
    return [f"{solver} is worse than fiedler" for solver, result in row.items() if result.worst > limit]


def _summary(solvers: Sequence[str], measured: Sequence[Row], best: Sequence[float]) -> list[list[str]]:
    """Return the mean ratios and times, and the number of graphs on which a solver finds the best value."""
    ratios = {
        solver: [row[solver].ncc / value for row, value in zip(measured, best, strict=True)] for solver in solvers
    }
    mean = [f"{statistics.mean(ratios[solver]):.4f}" for solver in solvers]
    mean_ms = [f"{1e3 * statistics.mean(row[solver].seconds for row in measured):.1f}" for solver in solvers]
    found = [f"{sum(ratio <= WITHIN for ratio in ratios[solver])} of {len(measured)}" for solver in solvers]
    return [["mean", "", *mean, *mean_ms], [f"at most {WITHIN}", "", *found]]


def _ratios(row: Row, best: float) -> list[str]:
    return [f"{result.ncc / best:.4f}" for result in row.values()]


def _milliseconds(row: Row) -> list[str]:
    return [f"{1e3 * result.seconds:.1f}" for result in row.values()]


def _demand_line(demand: Demand, references: Sequence[Reference], measured: Sequence[Row]) -> str:
    results: list[Measurement] = [row[demand.solver] for row in measured]
    pairs = list(zip(references, results, strict=True))
    good = [result.ncc <= demand.factor * demand.known(reference) for reference, result in pairs]
    quick = [result.seconds <= reference.six_starts_s / demand.share for reference, result in pairs]
    both = sum(a and b for a, b in zip(good, quick, strict=True))
    return (
        f"{demand.solver}: at most {demand.factor} x {demand.column} on {sum(good)}, "
        f"in at most 1/{demand.share} of seconds_runs5 on {sum(quick)}, both on {both} of {len(results)} graphs"
    )
