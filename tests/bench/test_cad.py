"""The solids of the sheet of CAD files, and the parts of the simplest of them."""

import numpy as np
import pytest
import trimesh

from bench.cad import cad_meshes
from segcore.mesh import Mesh
from segcore.method import segment


@pytest.fixture(scope="module")
def meshes() -> dict[str, Mesh]:
    return cad_meshes()


def test_the_solids_are_closed_and_connected(meshes: dict[str, Mesh]) -> None:
    assert len(meshes) == 40
    for mesh in meshes.values():
        solid = trimesh.Trimesh(mesh.vertices, mesh.faces)
        assert solid.is_volume
        assert solid.body_count == 1


def test_the_legs_of_a_table_are_parts(meshes: dict[str, Mesh]) -> None:
    """The table is symmetric, but the triangles around its legs are not."""
    mesh = meshes["table"]
    labels = segment(mesh).labels()
    is_leg = (mesh.corners[:, :, 2] < -0.0501).any(axis=1)
    assert labels.max() == 4
    assert len(np.unique(labels[~is_leg])) == 1
    centres = mesh.corners.mean(axis=1)[:, :2]
    quadrant = 2 * (centres[:, 0] > 0) + (centres[:, 1] > 0)
    of_legs = {tuple(np.unique(labels[is_leg & (quadrant == q)])) for q in range(4)}
    assert len(of_legs) == 4
    assert not of_legs & {(labels[~is_leg][0],)}


def test_both_flanges_of_a_pipe_are_parts(meshes: dict[str, Mesh]) -> None:
    mesh = meshes["pipe"]
    labels = segment(mesh).labels()
    centres = mesh.corners.mean(axis=1)
    rims = [labels[(np.linalg.norm(centres[:, :2], axis=1) > 0.69) & (side * centres[:, 2] > 0)] for side in (-1, 1)]
    one, other = (set(rim.tolist()) for rim in rims)
    assert len(one) == len(other) == 1
    assert one != other


def test_all_teeth_of_a_gear_are_parts(meshes: dict[str, Mesh]) -> None:
    mesh = meshes["gear"]
    labels = segment(mesh).labels()
    centres = mesh.corners.mean(axis=1)
    outer = np.linalg.norm(mesh.corners[:, :, :2], axis=2).min(axis=1) > 1.05
    tooth = np.round(np.arctan2(centres[:, 1], centres[:, 0]) / (2 * np.pi / 16)).astype(int) % 16
    of_teeth = [set(labels[outer & (tooth == t)].tolist()) for t in range(16)]
    assert all(len(own) == 1 for own in of_teeth)
    assert len(set().union(*of_teeth)) == 16


def test_a_plate_with_holes_is_one_part(meshes: dict[str, Mesh]) -> None:
    assert segment(meshes["plate"]).labels().max() == 0


def test_the_holes_of_a_flange_are_no_parts(meshes: dict[str, Mesh]) -> None:
    """The pipe and the disc are, and the walls of all eight holes belong to the disc."""
    mesh = meshes["flange"]
    labels = segment(mesh).labels()
    radius = np.linalg.norm(mesh.corners[:, :, :2], axis=2)
    in_disc = (radius.min(axis=1) > 0.6) & (radius.max(axis=1) < 0.9) & (np.ptp(mesh.corners[:, :, 2], axis=1) > 0.1)
    assert in_disc.sum() == 8 * 2 * 64
    outside = labels[radius.min(axis=1) > 0.99]
    assert set(labels[in_disc]) == set(outside)
    assert labels.max() == 1


def test_all_teeth_of_a_comb_are_parts(meshes: dict[str, Mesh]) -> None:
    """They are as thick as the board that they are cut from, so that their necks run across flat faces."""
    mesh = meshes["comb"]
    labels = segment(mesh).labels()
    ends = labels[mesh.corners[:, :, 2].max(axis=1) < -0.89]
    assert labels.max() == 12
    assert len(set(ends)) == 12


def test_bosses_around_holes_are_parts(meshes: dict[str, Mesh]) -> None:
    """The plate is drilled through its four bosses."""
    assert segment(meshes["bosses"]).labels().max() == 4


def test_both_flanges_of_a_beam_are_parts(meshes: dict[str, Mesh]) -> None:
    mesh = meshes["beam"]
    labels = segment(mesh).labels()
    height = mesh.corners[:, :, 2]
    top, bottom = (set(labels[(side * height).min(axis=1) > 0.39]) for side in (1, -1))
    web = set(labels[np.abs(mesh.corners[:, :, 0]).max(axis=1) < 0.051])
    assert len(top) == len(web) == len(bottom) == 1
    assert len(top | web | bottom) == 3
