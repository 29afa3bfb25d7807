"""Units and axes: known from the file or said by a caller, and converted by writers of formats that have their own."""

import io
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from helpers.hierarchies import hierarchy_of
from segcore.coordinates import Coordinates
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io import WRITERS, read_mesh, read_result, with_coordinates
from segcore.io.converting import converted
from segcore.mesh import Mesh

BOX = trimesh.creation.box((0.05, 0.2, 0.1))  # 5 cm wide, 20 cm high and 10 cm deep if it is in metres with y up


def of_file(kind: str, **said: str) -> Mesh:
    return read_mesh(io.BytesIO(BOX.export(file_type=kind)), kind, appearance=True, **said)


def one_part(mesh: Mesh) -> Hierarchy:
    hierarchy = hierarchy_of([], np.zeros(len(mesh.faces), dtype=np.int32), 1)
    return replace(hierarchy, face_count=np.array([len(mesh.faces)], dtype=np.int32))


def size_in(kind: str, data: bytes) -> list[float]:
    scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False)
    return scene.extents.tolist()


def output(mesh: Mesh, kind: str, **options: object) -> bytes:
    target = io.BytesIO()
    WRITERS[kind].write(target, mesh, one_part(mesh), None, **options)
    return target.getvalue()


@pytest.mark.parametrize(
    ("kind", "coordinates"),
    [
        ("glb", Coordinates("meter", "y", "y")),
        ("3mf", Coordinates("millimeter", "z", "z")),
        ("stl", Coordinates(None, None, "z")),
        ("obj", Coordinates(None, None, "y")),
        ("ply", Coordinates(None, None, "y")),
        ("off", Coordinates(None, None, "y")),
    ],
)
def test_formats_name_their_unit_and_axis_or_do_not(kind: str, coordinates: Coordinates) -> None:
    data = output(of_file("glb"), "3mf") if kind == "3mf" else BOX.export(file_type=kind)
    assert read_mesh(io.BytesIO(data.encode() if isinstance(data, str) else data)).coordinates == coordinates


def test_five_centimetres_of_gltf_are_fifty_millimetres_of_3mf_and_stand_upright() -> None:
    assert size_in("3mf", output(of_file("glb"), "3mf")) == pytest.approx([50, 100, 200])


def test_a_3mf_file_is_in_metres_and_upright_as_glb() -> None:
    mesh = read_mesh(io.BytesIO(output(of_file("glb"), "3mf")))
    assert size_in("glb", output(mesh, "glb")) == pytest.approx([0.05, 0.2, 0.1])
    assert mesh.bounds[1][2] - mesh.bounds[0][2] == pytest.approx(200)  # the mesh itself stays as it is in the file


def test_converted_glb_files_are_in_place_and_not_mirrored() -> None:
    moved = trimesh.creation.icosphere(1).apply_scale([1, 2, 3]).apply_translation([100, 20, 3])
    source = read_mesh(io.BytesIO(moved.export(file_type="stl")), unit="mm", up="z")
    scene = trimesh.load_scene(io.BytesIO(output(source, "glb")), file_type="glb", process=False)
    shape = scene.to_mesh()
    assert shape.bounds.mean(axis=0) == pytest.approx([0.1, 0.003, -0.02])
    assert shape.volume == pytest.approx(moved.volume * 1e-9, rel=1e-5)  # negative if it were mirrored


def test_numbers_whose_unit_is_not_known_are_written_as_they_are() -> None:
    for kind in ("3mf", "glb"):
        assert size_in(kind, output(of_file("stl"), kind)) == pytest.approx([0.05, 0.2, 0.1])


def test_what_is_said_of_a_file_counts() -> None:
    mesh = of_file("stl", unit="inch", up="y")
    assert mesh.coordinates == Coordinates("inch", "y", "z")
    assert mesh.notes == ()
    assert size_in("3mf", output(mesh, "3mf")) == pytest.approx([25.4 * 0.05, 25.4 * 0.1, 25.4 * 0.2])


def test_what_is_said_against_the_file_counts_and_is_noted() -> None:
    mesh = of_file("glb", unit="mm")
    assert mesh.coordinates == Coordinates("millimeter", "y", "y")
    assert mesh.notes == ("The unit is millimeter, as was said, and not meter as the file has it.",)


@pytest.mark.parametrize("said", [{"unit": "parsec"}, {"up": "x"}])
def test_units_and_axes_that_do_not_exist_are_refused(said: dict[str, str]) -> None:
    with pytest.raises(InvalidParameters):
        of_file("stl", **said)


@pytest.mark.parametrize("kind", ["obj", "ply"])
def test_formats_without_a_unit_are_converted_if_somebody_wants_it(kind: str) -> None:
    mesh = of_file("glb")
    assert size_in(kind, output(mesh, kind)) == pytest.approx([0.05, 0.2, 0.1])
    assert size_in(kind, output(mesh, kind, unit="cm", up="z")) == pytest.approx([5, 10, 20])


def test_parts_are_converted_if_somebody_wants_it() -> None:
    archive = zipfile.ZipFile(io.BytesIO(output(of_file("glb"), "zip", unit="mm", up="z")))
    name = next(name for name in archive.namelist() if name.endswith(".stl"))
    assert size_in("stl", archive.read(name)) == pytest.approx([50, 100, 200])


@pytest.mark.parametrize("wanted", [{"unit": "mm"}, {"up": "z"}])
@pytest.mark.parametrize("kind", ["obj", "ply", "zip"])
def test_a_mesh_without_a_known_unit_or_axis_is_not_converted(kind: str, wanted: dict[str, str]) -> None:
    with pytest.raises(InvalidParameters, match="not known"):
        output(of_file("stl"), kind, **wanted)


def test_normals_turn_with_the_mesh() -> None:
    mesh = read_mesh(io.BytesIO(BOX.export(file_type="glb", include_normals=True)), appearance=True)
    turned = converted(mesh, "millimeter", "z")
    assert mesh.appearance is not None
    assert turned.appearance is not None
    before, after = mesh.appearance.normals, turned.appearance.normals
    assert before is not None
    assert after is not None
    np.testing.assert_allclose(after, before[:, [0, 2, 1]] * [1, -1, 1], atol=1e-7)


def test_result_files_keep_the_unit_and_the_axis(tmp_path: Path) -> None:
    mesh = of_file("stl", unit="mm", up="z")
    path = tmp_path / "box.cleave"
    path.write_bytes(output(mesh, "cleave"))
    assert read_result(path).mesh.coordinates == Coordinates("millimeter", "z", "z")


def test_what_is_said_later_counts_too() -> None:
    assert with_coordinates(of_file("stl"), "mm", "z").coordinates == Coordinates("millimeter", "z", "z")
