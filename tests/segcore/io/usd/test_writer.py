"""USD as the reader and the validators of OpenUSD see it."""

import io
import sys
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdShade, UsdValidation

from helpers.files.written import written
from helpers.printing.bars import bar
from segcore.appearance import Appearance
from segcore.coordinates import Coordinates
from segcore.errors import MissingPackage
from segcore.hierarchy import Hierarchy
from segcore.io import read_mesh
from segcore.io.palette import linear_rgb
from segcore.mesh import Mesh

# A cube whose faces are quadrilaterals.
CUBE = b"""OFF
8 6 0
0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1
4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7
"""
NAMES = {0: "Körper 1", 1: "9 lives", 2: "parts_0"}


def cube() -> tuple[Mesh, Hierarchy]:
    """The cube with a hierarchy of four leaves, of which the automatic level has two segments."""
    mesh = read_mesh(io.BytesIO(CUBE), unit="mm", up="z")
    leaf = np.array([5, 2, 4, 6, 6, 4], dtype=np.int32).repeat(2)
    hierarchy = Hierarchy(
        split_node=np.array([0, 1, 3], dtype=np.int32),
        cut_value=np.ones(3),
        area=np.array([6.0, 5, 1, 3, 2, 1, 2]),
        face_count=np.array([12, 10, 2, 6, 4, 2, 4], dtype=np.int32),
        face_leaf=leaf,
        automatic_segments=2,
    )
    return mesh, hierarchy


def stage_of(tmp_path: Path, kind: str, mesh: Mesh, hierarchy: Hierarchy, *arguments: object, **options: object):
    path = tmp_path / f"model.{kind}"
    path.write_bytes(written(kind, mesh, hierarchy, *arguments, **options))
    return Usd.Stage.Open(str(path))


def labels_of(geometry: UsdGeom.Mesh, family: str) -> tuple[list[int], list[str]]:
    """The place of the subset that each face is in, and the names of the subsets."""
    subsets = [UsdGeom.Subset(one) for one in UsdGeom.Subset.GetGeomSubsets(geometry, UsdGeom.Tokens.face, family)]
    labels = np.full(len(geometry.GetFaceVertexCountsAttr().Get()), -1)
    for label, subset in enumerate(subsets):
        labels[np.array(subset.GetIndicesAttr().Get())] = label
    return labels.tolist(), [subset.GetPrim().GetName() for subset in subsets]


@pytest.mark.parametrize("kind", ["usdc", "usdz"])
def test_the_validators_of_openusd_find_nothing(tmp_path: Path, kind: str) -> None:
    stage = stage_of(tmp_path, kind, *cube(), 3, names=NAMES)
    known = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(known) > 20
    assert UsdValidation.ValidationContext(known).Validate(stage) == []
    geometry = UsdGeom.Mesh(stage.GetPrimAtPath("/Model/Mesh"))
    families = UsdGeom.Subset.GetAllGeomSubsetFamilyNames(geometry)
    assert set(families) == {"materialBind", "parts", "level_3", "level_4"}
    assert all(UsdGeom.Subset.ValidateFamily(geometry, UsdGeom.Tokens.face, family)[0] for family in families)
    assert {UsdGeom.Subset.GetFamilyType(geometry, family) for family in families} == {UsdGeom.Tokens.partition}


def test_the_families_are_the_levels_and_the_faces_are_the_polygons(tmp_path: Path) -> None:
    mesh, hierarchy = cube()
    stage = stage_of(tmp_path, "usdc", mesh, hierarchy, 3, names=NAMES)
    geometry = UsdGeom.Mesh(stage.GetDefaultPrim().GetChild("Mesh"))
    assert list(geometry.GetFaceVertexCountsAttr().Get()) == [4] * 6
    assert np.array(geometry.GetPointsAttr().Get()).tolist() == mesh.vertices.tolist()
    for family, segments in (("materialBind", 3), ("parts", 2), ("level_3", 3), ("level_4", 4)):
        assert labels_of(geometry, family)[0] == hierarchy.labels(segments)[::2].tolist()
    assert labels_of(geometry, "materialBind")[1] == ["K_rper_1", "_9_lives", "parts_0_2"]
    displayed = [geometry.GetPrim().GetChild(name).GetDisplayName() for name in ("K_rper_1", "_9_lives", "parts_0_2")]
    assert displayed == list(NAMES.values())
    part = UsdGeom.PrimvarsAPI(geometry).GetPrimvar("part")
    assert (part.GetInterpolation(), list(part.Get())) == ("uniform", hierarchy.labels(3)[::2].tolist())


def test_each_part_has_a_material_of_its_colour(tmp_path: Path) -> None:
    stage = stage_of(tmp_path, "usdc", *cube(), names=NAMES, part_colors={1: "#ff8000"})
    subset = stage.GetPrimAtPath("/Model/Mesh/_9_lives")
    material = UsdShade.MaterialBindingAPI(subset).ComputeBoundMaterial()[0]
    assert material.GetPath() == "/Model/Materials/_9_lives"
    shader = material.ComputeSurfaceSource()[0]
    assert shader.GetIdAttr().Get() == "UsdPreviewSurface"
    color = np.array(shader.GetInput("diffuseColor").Get())
    assert color == pytest.approx(linear_rgb(np.array([255, 128, 0]) / 255), abs=1e-6)


@pytest.mark.parametrize(
    ("coordinates", "meters", "up"),
    [(Coordinates("millimeter", "z"), 0.001, "Z"), (Coordinates(usual_up="z"), 1.0, "Z"), (Coordinates(), 1.0, "Y")],
)
def test_unit_and_axis_are_those_of_the_mesh(tmp_path: Path, coordinates: Coordinates, meters: float, up: str) -> None:
    stage = stage_of(tmp_path, "usdc", *bar(coordinates=coordinates))
    assert (UsdGeom.GetStageMetersPerUnit(stage), UsdGeom.GetStageUpAxis(stage)) == (meters, up)


def test_details_far_from_the_origin_are_kept(tmp_path: Path) -> None:
    mesh, hierarchy = bar()
    far = Mesh(mesh.vertices + 1e7, mesh.faces)
    stage = stage_of(tmp_path, "usdc", far, hierarchy)
    geometry = UsdGeom.Mesh(stage.GetPrimAtPath("/Model/Mesh"))
    place = np.array(geometry.ComputeLocalToWorldTransform(0))
    points = np.array(geometry.GetPointsAttr().Get(), dtype=float) @ place[:3, :3] + place[3, :3]
    assert np.abs(points - far.vertices).max() < 1e-4


def test_texture_coordinates_and_normals_are_those_of_the_corners(tmp_path: Path) -> None:
    mesh, hierarchy = bar()
    uvs = np.random.default_rng(1).random((len(mesh.vertices), 2)).astype(np.float32)
    normals = np.tile(np.array([0, 0, 1], np.float32), (len(mesh.vertices), 1))
    dressed = Mesh(mesh.vertices, mesh.faces, None, Appearance(normals=normals, uvs=uvs))
    stage = stage_of(tmp_path, "usdc", dressed, hierarchy)
    primvars = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/Model/Mesh"))
    found = np.array(primvars.GetPrimvar("st").ComputeFlattened())
    assert found == pytest.approx((uvs * [1, -1] + [0, 1])[mesh.faces.reshape(-1)], abs=1e-6)
    assert np.array(primvars.GetPrimvar("normals").ComputeFlattened()).tolist() == [[0, 0, 1]] * mesh.faces.size


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == "pxr"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pxr", None)
    for kind in ("usdc", "usdz"):
        with pytest.raises(MissingPackage, match=r"cleave-mesh\[usd\]"):
            written(kind, *cube())
