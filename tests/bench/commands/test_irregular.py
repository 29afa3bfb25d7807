"""The table of the irregular command."""

from bench.commands.irregular import render
from bench.princeton.dataset import Model


def test_the_table_has_the_means_of_the_versions(tmp_path):
    models = [Model(number, "Rod", 3, tmp_path, tmp_path) for number in (1, 3)]
    text = render(models, ["slivers", "remeshed"], [[0.9, 1.0], [0.8, 0.96]])
    rows = [line.split() for line in text.splitlines()]
    assert ["slivers", "0.8500", "0.0500", "0.8000", "0%"] in rows
    assert ["remeshed", "0.9800", "0.0200", "0.9600", "100%"] in rows
