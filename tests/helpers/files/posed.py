"""glTF assets whose vertices are moved by skins, morph targets or copies."""

from typing import Any

from helpers.files.gltf import FLOAT, Asset
from helpers.files.samples import gltf_square

BYTE, SHORT, UNSIGNED_BYTE, UNSIGNED_SHORT = 5120, 5122, 5121, 5123
FIRST, SECOND = [(0, 0, 0, 0)] * 4, [(1, 0, 0, 0)] * 4
WHOLE = [(1.0, 0.0, 0.0, 0.0)] * 4


def shifted(x: float, y: float, z: float, scale: float = 1.0) -> tuple[float, ...]:
    """A matrix of glTF, by columns."""
    return (scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0, x, y, z, 1)


def skinned(
    joints: list[tuple[int, ...]],
    weights: list[tuple[float, ...]],
    binds: list[tuple[float, ...]] | None = None,
    component: int = UNSIGNED_BYTE,
    weight_component: int = FLOAT,
) -> Asset:
    """The square with a skin of two joints at x = 10 and y = 20, below a node that scales by 2."""
    asset = gltf_square()
    attributes = asset.document["meshes"][0]["primitives"][0]["attributes"]
    attributes["JOINTS_0"] = asset.accessor(joints, component)
    attributes["WEIGHTS_0"] = asset.accessor(weights, weight_component, normalized=weight_component != FLOAT)
    first, second = (asset.add("nodes", {"translation": at}) for at in ([10, 0, 0], [0, 20, 0]))
    asset.root(scale=[2, 2, 2], children=[first, second])
    skin: dict[str, Any] = {"joints": [first, second]}
    if binds is not None:
        skin["inverseBindMatrices"] = asset.accessor(binds, FLOAT)
    asset.document["skins"] = [skin]
    asset.document["nodes"][0] |= {"skin": 0, "translation": [100, 100, 100]}
    return asset


def morphed(weights: list[float] | None = None) -> Asset:
    """The square with two morph targets, of floats and of normalized bytes."""
    asset = gltf_square()
    targets = [asset.accessor([(0.0, 0, 4)] * 4, FLOAT), asset.accessor([(127, 0, 0)] * 4, BYTE, normalized=True)]
    asset.document["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": target} for target in targets]
    if weights is not None:
        asset.document["meshes"][0]["weights"] = weights
    return asset


def instanced(**attributes: int) -> Asset:
    asset = gltf_square()
    asset.document["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    return asset


def blended() -> Asset:
    """Morph targets, then a skin with inverse bind matrices and weights that do not sum to 1; one vertex has none."""
    weights = [(0.25, 0.25, 0, 0), (0.9, 0.3, 0.2, 0), (0.0, 0, 0, 0), (0, 1, 0, 0)]
    asset = skinned([(0, 1, 0, 0)] * 4, weights, [shifted(1, 2, 3, 0.5), shifted(0, -1, 0)])
    asset.document["nodes"][1]["rotation"] = [0.6, 0, 0, 0.8]
    targets = [asset.accessor([(0.0, k, 4)] * 4, FLOAT) for k in range(2)]
    asset.document["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": target} for target in targets]
    asset.document["meshes"][0]["weights"] = [0.5, -1]
    asset.root(mesh=asset.add("meshes", {"primitives": [asset.primitive(0, [0, 1, 2])]}), scale=[3, 1, 1])
    return asset


def copied() -> Asset:
    asset = instanced()
    asset.document["nodes"][0] |= {"translation": [1, 2, 3], "scale": [2, 3, 4]}
    asset.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        "TRANSLATION": asset.accessor([(float(k), 0, 0) for k in range(3)], FLOAT),
        "ROTATION": asset.accessor([(0, 0, 0, 1), (0.6, 0, 0, 0.8), (0, 0.28, 0.96, 0)], FLOAT),
        "SCALE": asset.accessor([(1.0, 2, 3)] * 3, FLOAT),
    }
    asset.document["extensionsUsed"] = ["EXT_mesh_gpu_instancing"]
    return asset
