"""write_mesh: our readers and other programs read back the mesh that was written."""

import io
from pathlib import Path

import meshio
import numpy as np
import pytest
import trimesh
from hypothesis import given

from helpers.files.appearances import looks
from helpers.files.hierarchies import mesh_of
from helpers.files.polygon_soups import Soup, read, triangle_soups
from helpers.files.written import mesh_bytes
from segcore import InvalidParameters, UnsupportedFormat, shapes
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh, write_mesh
from segcore.mesh import Mesh

EXACT = ("off", "ply", "obj")
FORMATS = (*EXACT, "stl")


@pytest.mark.parametrize("name", EXACT)
@given(triangle_soups())
def test_vertices_and_faces_are_read_back_exactly(name: str, soup: Soup) -> None:
    mesh = mesh_of(soup)
    exact = Mesh(mesh.vertices / 3, mesh.faces)  # not in float32
    for written in (mesh, exact):
        back = read(mesh_bytes(written, name), name)
        assert back.vertices.tolist() == written.vertices.tolist()
        assert back.faces.tolist() == written.faces.tolist()


@given(triangle_soups())
def test_the_corners_of_stl_are_those_of_the_mesh_in_float32(soup: Soup) -> None:
    mesh = mesh_of(soup)
    data = mesh_bytes(mesh, "stl")
    corners = mesh.corners - offset_in(data)
    assert read(data, "stl").corners.tolist() == corners.astype("f4").tolist()


def offset_in(data: bytes) -> np.ndarray:
    """The offset that the header of an STL file begins with, 0 if it has none."""
    words = data[:80].decode("ascii").replace(",", "").split()
    return np.array(words[1:4] if words[0] == "offset" else [0, 0, 0], dtype=np.float64)


def test_an_stl_file_of_a_mesh_far_from_the_origin_keeps_its_details() -> None:
    ball = shapes.icosphere(2)
    far = Mesh(ball.vertices + np.array([500_000.0, 4_500_000.0, 0.1]), ball.faces)
    data = mesh_bytes(far, "stl")
    assert np.abs(offset_in(data) - [500_000, 4_500_000, 0]).max() <= 1
    np.testing.assert_allclose(read(data).corners + offset_in(data), far.corners, rtol=0, atol=1e-6)
    assert (offset_in(mesh_bytes(Mesh(ball.vertices + 100, ball.faces), "stl")) == 0).all()


@pytest.mark.parametrize("name", FORMATS)
def test_trimesh_and_meshio_read_the_same_triangles(name: str, tmp_path: Path) -> None:
    mesh = shapes.icosphere(2)
    path = tmp_path / f"ball.{name.upper()}"
    write_mesh(path, mesh)
    theirs = meshio.read(path, file_format=name)
    corners = {
        "trimesh": trimesh.load_mesh(io.BytesIO(path.read_bytes()), file_type=name, process=False).triangles,
        "meshio": theirs.points[theirs.cells_dict["triangle"]],
    }
    for program, found in corners.items():
        np.testing.assert_allclose(found, mesh.corners, rtol=0, atol=1e-7, err_msg=program)


@pytest.mark.parametrize("name", FORMATS)
def test_a_path_and_a_file_get_the_same_bytes(name: str, tmp_path: Path) -> None:
    mesh = shapes.icosphere(1)
    write_mesh(tmp_path / f"a.{name}", mesh)
    write_mesh(str(tmp_path / "b.dat"), mesh, f".{name.upper()}")
    files = [path.read_bytes() for path in (tmp_path / f"a.{name}", tmp_path / "b.dat")]
    assert files == [mesh_bytes(mesh, name)] * 2


@given(looks())
def test_ply_and_obj_keep_the_appearance_of_the_vertices(looking: tuple[Mesh, Hierarchy]) -> None:
    mesh, _ = looking
    for name in ("ply", "obj"):
        back = read_mesh(io.BytesIO(mesh_bytes(mesh, name)), appearance=True).appearance
        if name == "ply" and len(mesh.appearance.extra_vertex):
            assert back is None
            continue
        for kind in ("normals", "uvs"):
            ours, theirs = (
                getattr(look, kind)[mesh.faces if look.corners is None else look.corners]
                for look in (mesh.appearance, back)
            )
            assert theirs.tolist() == ours.tolist()
        ours, theirs = (look.colors[: len(mesh.vertices), :3] for look in (mesh.appearance, back))
        assert theirs.tolist() == ours.tolist()


@pytest.mark.parametrize(("target", "name"), [("a.glb", None), ("a", None), (io.BytesIO(), None), ("a.off", "3mf")])
def test_another_format_is_refused_with_those_that_are_written(target: object, name: str | None) -> None:
    with pytest.raises(UnsupportedFormat, match="off, stl, ply, obj"):
        write_mesh(target, shapes.icosphere(0), name)


def test_a_file_that_stl_cannot_hold_is_not_begun(tmp_path: Path) -> None:
    mesh = shapes.icosphere(0, radius=1e60)
    with pytest.raises(InvalidParameters, match="OBJ"):
        write_mesh(tmp_path / "a.stl", mesh)
    assert not (tmp_path / "a.stl").exists()
