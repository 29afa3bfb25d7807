"""The scale command on small meshes."""

import pytest

from bench.__main__ import main
from bench.checkout import HERE
from bench.commands.scale import render, render_crowds, render_hard
from bench.scale import versions
from bench.scale.cost import STAGES, Cost
from bench.scale.hard_shapes import HARD_SHAPES
from segcore.method import segment
from segcore.shapes import dumbbell


def test_costs_are_per_face_and_add_up():
    cost = Cost("ball", 1000, dict.fromkeys(STAGES, 0.01), 500_000, 0.02)
    assert cost.total_s == pytest.approx(0.05)
    row = render([cost]).splitlines()[2].split()
    assert row == ["ball", "1000", *["0.010"] * 5, "0.050", "50.00", "0", "500", "0.02"]


def test_crowds_are_compared_with_the_first_one():
    costs = [Cost(name, 12, dict.fromkeys(STAGES, seconds), 0, 0.0) for name, seconds in (("one", 0.1), ("many", 0.2))]
    assert [line.split()[-1] for line in render_crowds(costs).splitlines()[2:]] == ["1.00", "2.00"]


def test_hard_meshes_are_compared_with_smooth_ones_of_their_size():
    hard, smooth = (Cost("any", 12, dict.fromkeys(STAGES, seconds), 0, seconds) for seconds in (0.5, 0.2))
    (line,) = render_hard([(hard, smooth)]).splitlines()[2:]
    assert line.split()[2:5] == ["2.50", "1.00", "2.50"]
    assert line.split()[-1] == "0.50"


def test_versions_are_compared_with_the_first_one():
    memory = dict.fromkeys(STAGES, 250000)
    runs = {
        "before": versions.Run(1000, 2.0, 4.0, memory | {"cut": 500_000}, {"a.py:1": 2.0}),
        "one thread": versions.Run(1000, 1.0, 1.0, memory, {"a.py:1": 0.1, "b.py:2": 0.9}),
    }
    assert versions.render_memory(runs).splitlines()[-1].split()[2:] == ["0"] * 5
    assert versions.render_lines(runs["one thread"], 1).splitlines()[-1].split() == ["b.py:2", "0.900"]
    assert versions.render(runs).splitlines()[-1].split()[2:] == ["1000", "1.00", "0.50", "1.00", "0.25", "0", "250"]


def test_this_version_is_measured_in_one_thread_and_in_two():
    runs = versions.compare(HERE, 300, runs=1)
    assert list(runs) == ["before", "one thread", "two threads"]
    assert {run.faces for run in runs.values()} == {len(dumbbell(rings=17, around=9).mesh.faces)}
    assert min(run.cpu_s for run in runs.values()) > 0
    assert {tuple(run.memory_bytes) for run in runs.values()} == {STAGES}
    assert all(sum(run.line_s.values()) > 0 for run in runs.values())


@pytest.mark.parametrize("name", HARD_SHAPES)
def test_hard_meshes_have_the_stated_size_and_can_be_segmented(name):
    mesh = HARD_SHAPES[name][0](2000)
    assert len(mesh.faces) == pytest.approx(2000, rel=0.1)
    hierarchy = segment(mesh)
    assert hierarchy.labels(hierarchy.max_segments).shape == (len(mesh.faces),)


def test_every_mesh_has_a_line(capsys):
    assert main(["scale", "--sizes", "200", "--runs", "1"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[2].split()[0] == "dumbbell"
    assert lines[-1].startswith("1,000 boxes that touch")


def test_a_size_below_100_faces_is_rejected(capsys):
    assert main(["scale", "--sizes", "5"]) == 2
    assert "--sizes" in capsys.readouterr().err
