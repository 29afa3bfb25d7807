"""Outputs that keep everything of their input look and move in three.js as the input does."""

import base64
import io
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser

from bench.kept.check import TIMES, compare
from bench.kept.three_page import ThreePage
from helpers.files.compressed_gltf import meshopt_asset
from helpers.files.kept import kept
from helpers.files.rich_gltf import VARIANTS, rich_asset
from helpers.hierarchies import hierarchy_of_labels
from helpers.node import programs
from segcore.io import read_mesh

EDGES = 4  # pixels in which faces of two parts are equally far away


@pytest.fixture(scope="module")
def page(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> ThreePage:
    folder = programs.install("three", tmp_path_factory.mktemp("three"))
    return ThreePage(browser, folder / "node_modules" / "three")


def files(tmp_path: Path) -> list[Path]:
    rich, separate, packed = tmp_path / "rich.glb", tmp_path / "separate.gltf", tmp_path / "packed.glb"
    rich.write_bytes(rich_asset().glb())
    asset = rich_asset()
    image = asset.document["images"][1]
    (tmp_path / "blue one.png").write_bytes(base64.b64decode(image["uri"].partition(",")[2]))
    image["uri"] = "blue%20one.png"
    separate.write_bytes(asset.gltf())
    packed.write_bytes(meshopt_asset().glb())
    return [rich, separate, packed]


def test_the_output_looks_and_moves_as_the_input(page: ThreePage, tmp_path: Path) -> None:
    for path in files(tmp_path):
        found = compare(path, page, None)
        assert found.drawn_pixels > 1000
        assert found.differing_pixels <= EDGES, path
        assert (found.lost_pictures, found.notes) == (0, 0), path
        assert found.largest_move < 1e-6


def test_animations_play(page: ThreePage) -> None:
    page.models = {"rich": rich_asset().glb()}
    before, after = (page.triangles("rich", seconds) for seconds in TIMES)
    assert np.abs(after - before).max() > 0.1


def test_variants_show_the_parts_and_the_original(page: ThreePage) -> None:
    asset = rich_asset()
    labels = np.arange(len(read_mesh(io.BytesIO(asset.glb())).faces)) % 3
    page.models = {"rich": asset.glb(), "kept": kept(asset.glb(), hierarchy_of_labels(labels))}
    assert VARIANTS.encode() in page.models["kept"]
    original = page.picture("rich")
    assert page.picture("kept") == page.picture("kept", variant="original look") == original
    assert (
        len({original, *(page.picture("kept", variant=name) for name in ("1 segment", "2 segments", "3 segments"))})
        == 4
    )
