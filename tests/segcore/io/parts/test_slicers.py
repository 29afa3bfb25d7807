"""Files for printing in the programs that print: PrusaSlicer, and lib3mf, the reader of the 3MF Consortium."""

from pathlib import Path

import lib3mf
import numpy as np
import pytest

from bench.printing.slicer import are_manifold, slice_file
from helpers.bodies.creatures import creature
from helpers.files.written import members, written
from helpers.meshes import exploded, moved
from helpers.printing.slicers import needs_slicer
from helpers.printing.solids import cup, halves, pipe
from segcore import shapes
from segcore.hierarchy import Hierarchy
from segcore.io.parts.pieces import closed_parts
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters

Segmented = tuple[Mesh, Hierarchy, int]


def segmented(name: str) -> Segmented:
    mesh = {
        "creature": lambda: creature(subdivisions=3),
        "burr": lambda: shapes.burr().mesh,
        "far away": lambda: moved(creature(subdivisions=3), (500_000.0, 4_500_000.0, 10.0)),
        "without shared vertices": lambda: exploded(creature(subdivisions=3)),
        "pipe": pipe,
        "cup": cup,
    }[name]()
    if name in ("pipe", "cup"):
        return mesh, halves(mesh, mesh.corners[:, :, 2].mean(axis=1) > 1.01), 2
    hierarchy = segment(mesh, SegmentationParameters(max_segments=20))
    return mesh, hierarchy, min(12, hierarchy.max_segments)


MODELS = ("creature", "burr", "far away", "without shared vertices", "pipe", "cup")


@needs_slicer
@pytest.mark.parametrize("name", MODELS)
def test_prusa_slicer_takes_every_object_for_manifold(name: str, tmp_path: Path) -> None:
    mesh, hierarchy, segments = segmented(name)
    (tmp_path / "model.3mf").write_bytes(written("3mf", mesh, hierarchy, segments))
    assert are_manifold([tmp_path / "model.3mf"]) == [True] * segments
    parts = [path for path in members(written("zip", mesh, hierarchy, segments)).items() if path[0].endswith(".stl")]
    for file, data in parts:
        (tmp_path / file).write_bytes(data)
    assert are_manifold([tmp_path / file for file, _ in parts]) == [True] * segments


@needs_slicer
def test_prusa_slicer_finds_the_open_parts_open(tmp_path: Path) -> None:
    (tmp_path / "open.3mf").write_bytes(written("3mf", *segmented("creature"), capped=False))
    assert not any(are_manifold([tmp_path / "open.3mf"]))


@needs_slicer
@pytest.mark.slow
def test_prusa_slicer_slices_closed_parts(tmp_path: Path) -> None:
    (tmp_path / "model.3mf").write_bytes(written("3mf", *segmented("creature")))
    slice_file(tmp_path / "model.3mf", tmp_path / "model.gcode", scale=20)
    assert (tmp_path / "model.gcode").read_text().count("\nG1 ") > 1000


@pytest.mark.parametrize("name", MODELS)
def test_lib3mf_reads_every_3mf_in_strict_mode_without_warnings(name: str) -> None:
    mesh, hierarchy, segments = segmented(name)
    groups = {0: 'a "left" & <right>'}
    for capped in (True, False):
        model = lib3mf.get_wrapper().CreateModel()
        reader = model.QueryReader("3mf")
        reader.SetStrictModeActive(True)
        reader.ReadFromBuffer(bytearray(written("3mf", mesh, hierarchy, segments, capped=capped, names=groups)))
        assert reader.GetWarningCount() == 0
        objects, found = model.GetMeshObjects(), []
        while objects.MoveNext():
            entry = objects.GetCurrentMeshObject()
            found.append((entry.GetName(), entry.GetTriangleCount()))
            if capped:
                assert entry.IsManifoldAndOriented()
        assert len(found) == segments
        assert found[0][0] == groups[0]
        if capped:
            expected = [len(part.faces) for part in closed_parts(mesh, hierarchy, segments)]
            assert [count for _, count in found] == expected
        assert np.sum([count for _, count in found]) >= len(mesh.faces)
