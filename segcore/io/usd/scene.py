"""The prims of a USD file: a mesh with its subsets of faces, and the materials of the parts."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from segcore.appearance import Appearance
from segcore.arrays import FloatArray, IntArray
from segcore.coordinates import UNKNOWN, Coordinates
from segcore.io.gltf.writer_geometry import place
from segcore.io.slices import Slices
from segcore.io.usd.polygons import CornerLoops
from segcore.mesh import Mesh

MODEL = "/Model"
MESH = f"{MODEL}/Mesh"
_MATERIALS = f"{MODEL}/Materials"
_ROUGHNESS = 0.6  # of the materials, set by hand


def define_stage(usd: Any, stage: Any, coordinates: Coordinates) -> None:
    """Set what holds for the whole file. A mesh whose unit is not known is in metres, as in glTF."""
    model = usd.UsdGeom.Xform.Define(stage, MODEL).GetPrim()
    stage.SetDefaultPrim(model)
    usd.Usd.ModelAPI(model).SetKind(usd.Kind.Tokens.component)
    usd.UsdGeom.SetStageMetersPerUnit(stage, coordinates.scale_to("meter"))
    usd.UsdGeom.SetStageUpAxis(stage, coordinates.shown_up.upper())


def define_mesh(usd: Any, stage: Any, mesh: Mesh, loops: CornerLoops) -> Any:
    """Add the polygons with the normals and texture coordinates of the input, and return their prim."""
    placement = place(replace(mesh, appearance=None, coordinates=UNKNOWN))
    points = usd.Vt.Vec3fArray.FromNumpy(placement.positions)
    geometry = usd.UsdGeom.Mesh.Define(stage, MESH)
    geometry.CreatePointsAttr(points)
    geometry.CreateFaceVertexCountsAttr(usd.Vt.IntArray.FromNumpy(loops.sizes.astype(np.int32)))
    corners = mesh.faces.reshape(-1)[loops.corners]
    geometry.CreateFaceVertexIndicesAttr(usd.Vt.IntArray.FromNumpy(corners.astype(np.int32)))
    geometry.CreateExtentAttr(usd.UsdGeom.PointBased.ComputeExtent(points))
    geometry.CreateSubdivisionSchemeAttr(usd.UsdGeom.Tokens.none)
    geometry.CreateDoubleSidedAttr(True)
    if any(placement.translation):
        geometry.AddTranslateOp().Set(usd.Gf.Vec3d(*placement.translation))
    if placement.scale != 1.0:
        geometry.AddScaleOp().Set(usd.Gf.Vec3f(placement.scale))
    _add_appearance(usd, geometry, mesh, loops)
    return geometry


def _add_appearance(usd: Any, geometry: Any, mesh: Mesh, loops: CornerLoops) -> None:
    look = mesh.appearance or Appearance()
    rows = (mesh.faces if look.corners is None else look.corners).reshape(-1)[loops.corners].astype(np.int32)
    if look.uvs is not None:
        upwards = np.stack([look.uvs[:, 0], 1 - look.uvs[:, 1]], axis=1).astype(np.float32)  # v points up in USD
        values = usd.Vt.Vec2fArray.FromNumpy(upwards)
        _add_primvar(usd, geometry, "st", usd.Sdf.ValueTypeNames.TexCoord2fArray, values, rows)
    if look.normals is not None:
        values = usd.Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(look.normals))
        _add_primvar(usd, geometry, "normals", usd.Sdf.ValueTypeNames.Normal3fArray, values, rows)


def _add_primvar(usd: Any, geometry: Any, name: str, kind: Any, values: Any, rows: IntArray) -> None:
    """Add an attribute of the corners of polygons, given by the rows of its values."""
    primvar = usd.UsdGeom.PrimvarsAPI(geometry).CreatePrimvar(name, kind, usd.UsdGeom.Tokens.faceVarying)
    primvar.Set(values)
    primvar.SetIndices(usd.Vt.IntArray.FromNumpy(rows))


def add_labels(usd: Any, geometry: Any, labels: IntArray) -> None:
    """Add the label of every polygon as ``primvars:part``."""
    primvars = usd.UsdGeom.PrimvarsAPI(geometry)
    primvar = primvars.CreatePrimvar("part", usd.Sdf.ValueTypeNames.IntArray, usd.UsdGeom.Tokens.uniform)
    primvar.Set(usd.Vt.IntArray.FromNumpy(np.ascontiguousarray(labels)))


def add_family(
    usd: Any, geometry: Any, family: str, slices: Slices, prims: Sequence[str], titles: Sequence[str]
) -> list[Any]:
    """Add a subset of the polygons for each part, and return them.

    Parameters
    ----------
    prims, titles : the names of the prims, and those that programs display.
    """
    subsets = []
    for label, (prim, title) in enumerate(zip(prims, titles, strict=True)):
        faces = usd.Vt.IntArray.FromNumpy(slices[label])
        subset = usd.UsdGeom.Subset.CreateGeomSubset(geometry, prim, usd.UsdGeom.Tokens.face, faces, family)
        subset.GetPrim().SetDisplayName(title)
        subsets.append(subset)
    usd.UsdGeom.Subset.SetFamilyType(geometry, family, usd.UsdGeom.Tokens.partition)
    return subsets


def bind_materials(usd: Any, stage: Any, subsets: Sequence[Any], colors: FloatArray) -> None:
    """Give each subset a material of its name, with a colour in linear light."""
    usd.UsdGeom.Scope.Define(stage, _MATERIALS)
    for subset, color in zip(subsets, colors.tolist(), strict=True):
        prim = subset.GetPrim()
        material = usd.UsdShade.Material.Define(stage, f"{_MATERIALS}/{prim.GetName()}")
        material.GetPrim().SetDisplayName(prim.GetDisplayName())
        shader = usd.UsdShade.Shader.Define(stage, f"{material.GetPath()}/Surface")
        shader.CreateIdAttr("UsdPreviewSurface")
        shader.CreateInput("diffuseColor", usd.Sdf.ValueTypeNames.Color3f).Set(usd.Gf.Vec3f(*color))
        shader.CreateInput("roughness", usd.Sdf.ValueTypeNames.Float).Set(_ROUGHNESS)
        material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
        usd.UsdShade.MaterialBindingAPI.Apply(prim).Bind(material)
