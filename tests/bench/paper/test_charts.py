"""The bar charts of the metrics."""

from bench.paper.charts import PANELS, Bar, metric_chart
from bench.paper.evaluation import MethodResults
from bench.princeton.summary import overall


def test_the_chart_shows_every_value_and_those_of_the_people(results: dict[str, MethodResults]) -> None:
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
