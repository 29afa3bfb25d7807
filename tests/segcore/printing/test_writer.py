"""Files for printing in the programs that print: PrusaSlicer, and lib3mf, the reader of the 3MF Consortium."""

import io
import re
import zipfile
from pathlib import Path

import lib3mf
import pytest

import segcore
from bench.printing.slicer import are_manifold, tools_of, volumes
from helpers.printing.bars import bar
from helpers.printing.slicers import needs_slicer
from segcore.printing.options import PrintOptions
from segcore.printing.plan import plan_print
from segcore.printing.writer import write_print

COLORS = {0: "#ff0000", 1: "#00ff00"}


def printed(**options: object) -> bytes:
    target = io.BytesIO()
    write_print(target, plan_print(*bar(), options=PrintOptions(**options), part_colors=COLORS, names={1: 'a "b" <c>'}))
    return target.getvalue()


@pytest.mark.parametrize("slicer", ["any", "prusa", "bambu"])
@pytest.mark.parametrize("place", ["plate", "assembled"])
def test_lib3mf_reads_every_file_in_strict_mode_without_warnings(place: str, slicer: str) -> None:
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    data = printed(place=place, slicer=slicer)
    assert data == printed(place=place, slicer=slicer)
    reader.ReadFromBuffer(bytearray(data))
    assert reader.GetWarningCount() == 0
    objects, found = model.GetMeshObjects(), []
    while objects.MoveNext():
        assert objects.GetCurrentMeshObject().IsManifoldAndOriented()
        found.append(objects.GetCurrentMeshObject().GetName())
    is_merged = (place, slicer) == ("assembled", "prusa")
    assert found == (["assembly"] if is_merged else ["segment 0", 'a "b" <c>', "dowel 1"])
    text = b"".join(
        zipfile.ZipFile(io.BytesIO(data)).read(name) for name in zipfile.ZipFile(io.BytesIO(data)).namelist()
    )
    assert not re.search(rb"Application|BambuStudio-|PrusaSlicer|slic3rpe:Version", text)


def test_on_a_plate_objects_stand_on_the_bed_and_do_not_meet(tmp_path: Path) -> None:
    (tmp_path / "plate.3mf").write_bytes(printed(bed="100x100x100"))
    mesh = segcore.read_mesh(tmp_path / "plate.3mf")
    assert mesh.structure is not None
    assert mesh.structure.group is not None
    boxes = []
    for number in range(3):
        corners = mesh.corners[mesh.structure.group == number].reshape(-1, 3)
        boxes.append((corners.min(axis=0), corners.max(axis=0)))
    for k, (low, high) in enumerate(boxes):
        assert low[2] == pytest.approx(0.0, abs=1e-9)
        assert not any((low < other[1]).all() and (high > other[0]).all() for other in boxes[:k])


@needs_slicer
@pytest.mark.parametrize("place", ["plate", "assembled"])
def test_prusa_slicer_changes_the_tool_as_the_slots_say(place: str, tmp_path: Path) -> None:
    found = {}
    for slicer in ("prusa", "any"):
        path = tmp_path / f"{slicer}.3mf"
        path.write_bytes(printed(place=place, slicer=slicer, connectors="none"))
        assert all(are_manifold([path]))
        assert sum(volumes(path)) == pytest.approx(60.0 * 20.0 * 20.0, rel=1e-5)
        found[slicer] = tools_of(path, tmp_path, extruders=2)
    assert found == {"prusa": {0, 1}, "any": set()}
