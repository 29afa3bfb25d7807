"""What OpenUSD reads from a file."""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from pxr import Usd, UsdGeom


@dataclass(frozen=True, slots=True)
class UsdContent:
    """The mesh of a model."""

    properties: list[str]
    families: dict[str, list[str]]  # of subsets of its faces: the names of the subsets


def usd_content(data: bytes, kind: str) -> UsdContent:
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"model.{kind}"
        path.write_bytes(data)
        stage = Usd.Stage.Open(str(path))
        mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/Model/Mesh"))
        families = {
            family: [
                part.GetPrim().GetName() for part in UsdGeom.Subset.GetGeomSubsets(mesh, UsdGeom.Tokens.face, family)
            ]
            for family in UsdGeom.Subset.GetAllGeomSubsetFamilyNames(mesh)
        }
        return UsdContent(list(mesh.GetPrim().GetPropertyNames()), families)
