"""glTF with Draco: the mesh is that of another decoder, or the refusal names the reason."""

import sys

import numpy as np
import pytest

from helpers.files.compressed_gltf import DRACO, draco_asset
from helpers.files.polygon_soups import read, read_or_none
from segcore import shapes
from segcore.errors import InvalidMesh, UnsupportedFormat

DracoPy = pytest.importorskip("DracoPy")


def test_the_triangles_are_those_of_the_decoder_in_its_order() -> None:
    asset, data = draco_asset()
    mesh, decoded = read(asset.glb()), DracoPy.decode(data)
    assert mesh.vertices.tolist() == decoded.points.tolist()
    assert mesh.faces.tolist() == decoded.faces.tolist()


def test_the_shape_is_the_one_that_was_compressed() -> None:
    asset, _ = draco_asset()
    box = shapes.icosphere(2)
    ours, theirs = (np.sort(corners.mean(axis=1), axis=0) for corners in (read(asset.glb()).corners, box.corners))
    np.testing.assert_allclose(ours, theirs, atol=1e-4 * np.ptp(box.vertices))


def test_counts_that_contradict_the_data_are_refused() -> None:
    asset, _ = draco_asset()
    for accessor in (0, 1):
        asset.document["accessors"][accessor]["count"] += 3
        with pytest.raises(InvalidMesh, match=r"accessors\[\d\], which should have"):
            read(asset.glb())


def test_without_the_decoder_the_extension_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    asset, _ = draco_asset()
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    with pytest.raises(UnsupportedFormat, match=rf"{DRACO}.*cleave-mesh\[draco\]"):
        read(asset.glb())


def test_damaged_data_gives_a_mesh_or_a_typed_error() -> None:
    asset, data = draco_asset()
    whole = asset.glb()
    at = whole.index(data)
    rng = np.random.default_rng(8)
    for _ in range(300):
        damaged = bytearray(whole)
        for place in rng.integers(0, len(data), 3):
            damaged[at + place] = rng.integers(256)
        read_or_none(bytes(damaged))
    with pytest.raises(InvalidMesh, match=f"The data of {DRACO}"):
        read(whole[:at] + bytes(len(data)) + whole[at + len(data) :])
