"""The comparison of kernels on inputs that are small enough for a test."""

import math

import numpy as np
import pytest

from bench.__main__ import main
from bench.commands.kernels import render_numbers, render_rays, render_systems
from bench.kernels import numbers, rays, systems
from bench.kernels.numbers import NumberTimes
from bench.kernels.rays import RayTimes
from bench.kernels.systems import SystemTimes
from segcore import shapes


def test_all_methods_solve_the_same_system() -> None:
    system = systems.smoothing_laplacian(shapes.icosphere(2))
    b = np.random.default_rng(0).standard_normal(system.node_count - 1)
    for factorise in systems.methods(system).values():
        np.testing.assert_allclose(system.matrix @ factorise().solve(b), b, atol=1e-9)


def test_the_coarse_graph_of_a_mesh_is_measured_by_every_method() -> None:
    measured = systems.measure(systems.coarse_laplacian(shapes.dumbbell(20, 12).mesh), runs=1)
    assert len(measured) == 4
    assert all(times.entries > 0 and times.factorise_s > 0 for times in measured.values())


def test_elimination_without_subtractions_sees_a_weak_bridge() -> None:
    errors = systems.bridge_errors()
    assert errors["Cleave"] < 1e-14
    assert errors["SuperLU, MMD_AT_PLUS_A"] > 1e-3


def test_no_number_is_parsed_wrong() -> None:
    for decimals in (6, 16):
        measured = numbers.measure(numbers.vertex_lines(100, decimals), runs=1)
        assert [times.wrong for times in measured.values()] == [0, 0, 0, 0]


def test_rays_are_cast_from_within() -> None:
    """Rays into a ball meet the other side at 2 cos(angle), at most 60 degrees from the normal."""
    surface = rays.build_surface(shapes.icosphere(4))
    distance = rays.cleave(surface, rays.rays_inward(surface, 200))()
    diameter = np.ptp(surface.vertices[:, 0])
    assert ((distance > 0.45 * diameter) & (distance < 1.01 * diameter)).all()


def test_the_subdivided_mesh_has_enough_faces() -> None:
    assert len(rays.subdivided(shapes.box(), 100).faces) == 192


def test_ratios_are_to_cleave() -> None:
    times = {"Cleave": SystemTimes(10, 0.002, 1e-4), "Other": SystemTimes(20, 0.004, 3e-4)}
    lines = render_systems("graphs", [times], {"Cleave": 1e-16, "Other": math.inf}).splitlines()
    assert lines[2].split() == ["Cleave", "10", "2.00", "1.00", "0.100", "1.00", "1e-16"]
    assert lines[3].split() == ["Other", "20", "4.00", "2.00", "0.300", "3.00", "singular"]
    cast = {"Cleave": RayTimes(0.01, 0.03, 1.0), "Other": RayTimes(0.01, 0.01, 0.999)}
    assert render_rays("rays", [cast]).splitlines()[3].split() == ["Other", "10.0", "10.0", "0.50", "0.99900"]
    parsed = {"Cleave": NumberTimes(0.02, 0), "Other": NumberTimes(0.1, 3)}
    assert render_numbers("text", parsed).splitlines()[3].split() == ["Other", "100.0", "5.00", "3"]


def test_no_runs_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["kernels", "--data", "nowhere", "--runs", "0"]) == 2
    assert "--runs" in capsys.readouterr().err
