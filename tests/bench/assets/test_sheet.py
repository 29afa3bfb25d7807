"""The contact sheets: the picture of a model, and a file for every set."""

import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.assets.dataset import NO_PART, read_assets
from bench.assets.evaluation import Evaluation, evaluate_asset
from bench.assets.sheet import draw_tile, save_sheets, sheet, upright
from bench.errors import BenchmarkError
from helpers.hierarchies import HeightSegmenter
from segcore.io.palette import color_bytes
from segcore.shapes import box, joined

PNG_SIZE = slice(16, 24)  # width and height in the first chunk


def hues(pixels: np.ndarray) -> set[tuple[int, int, int]]:
    """Return the colours of the labels 0 to 3 that occur, and grey as 0, 0, 0; shades and lines are left out."""
    colors = color_bytes(4).astype(float)
    flat = pixels.reshape(-1, 4)[:, :3].astype(float)
    flat = flat[(flat.min(axis=1) < 250) & (flat.max(axis=1) > 120)]
    grey = np.ptp(flat, axis=1) == 0
    found = {(0, 0, 0)} if grey.mean() > 0.05 else set()
    direction = flat / np.linalg.norm(flat, axis=1, keepdims=True)
    for color in colors:
        near = direction @ (color / np.linalg.norm(color)) > 0.9999
        if near.mean() > 0.05:
            found.add(tuple(color.astype(int).tolist()))
    return found


def test_segments_have_the_colours_of_their_parts_and_faces_without_a_part_are_grey() -> None:
    three = joined(box(), box(centre=(2, 0, 0)), box(centre=(4, 0, 0)))
    part = np.where(three.parts == 2, NO_PART, three.parts).astype(np.int64)
    renamed = np.array([2, 0, 1])[three.parts].astype(np.int32)
    pixels = draw_tile(three.mesh, renamed, part)
    height, width, _ = pixels.shape
    assert width == 2 * height
    first, second, third = (tuple(color) for color in color_bytes(3).tolist())
    assert hues(pixels[:, :height]) == {first, second, third}
    assert hues(pixels[:, height:]) == {first, second, (0, 0, 0)}
    left, right = (np.where(hue[..., :3].min(axis=2) < 250) for hue in (pixels[:, :height], pixels[:, height:]))
    assert np.array_equal(left, right)


def test_robots_stand_upright(assets: Path) -> None:
    _, bell = read_assets(assets)
    mesh = bell.read_mesh()
    assert np.argmax(np.ptp(mesh.vertices, axis=0)) == 2
    standing = upright(bell, mesh)
    assert np.argmax(np.ptp(standing.vertices, axis=0)) == 1
    assert np.linalg.det(np.linalg.lstsq(mesh.vertices, standing.vertices)[0]) == pytest.approx(1.0)
    assert upright(replace(bell, collection="props"), mesh) is mesh


@pytest.fixture
def drawn(assets: Path) -> list[Evaluation]:
    """Both assets, and the second one six times more."""
    crate, bell = (evaluate_asset(asset, HeightSegmenter(), 0, drawn=True) for asset in read_assets(assets))
    return [crate, *[bell] * 7]


def test_every_set_has_a_sheet_with_rows_of_five(drawn: list[Evaluation], tmp_path: Path) -> None:
    paths = save_sheets(tmp_path / "new" / "sheets", drawn)
    assert [path.name for path in paths] == ["props.png", "robots.png"]
    sizes = [np.frombuffer(path.read_bytes()[PNG_SIZE], dtype=">u4") for path in paths]
    assert sizes[1].tolist() == (sizes[0] * [5, 2]).tolist()
    before = [zlib.crc32(path.read_bytes()) for path in paths]
    save_sheets(tmp_path / "new" / "sheets", drawn)
    assert [zlib.crc32(path.read_bytes()) for path in paths] == before


def test_the_name_and_the_scores_are_under_every_model(drawn: list[Evaluation]) -> None:
    crate, bell = drawn[:2]
    texts = [text.get_text() for text in sheet([crate, bell]).texts]
    score = f"{bell.result.automatic.one_minus_rand:.3f}"
    assert texts[1] == f"bell\n2 of 3 parts, 1-Rand {score}"
    assert texts[0].startswith("crate\n")


def test_a_folder_that_cannot_be_made_is_an_error(drawn: list[Evaluation], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BenchmarkError, match="cannot be written"):
        save_sheets(tmp_path / "file" / "sheets", drawn)
