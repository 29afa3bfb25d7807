"""The folder of the authored assets."""

from pathlib import Path

import numpy as np
import pytest

from bench.assets.dataset import NO_PART, read_assets
from bench.errors import BenchmarkError


def test_every_asset_has_a_mesh_and_a_part_of_every_face(assets: Path) -> None:
    crate, bell = read_assets(assets)
    assert [(one.collection, one.name, one.parts) for one in (crate, bell)] == [
        ("props", "crate", 1),
        ("robots", "bell", 3),
    ]
    assert len(crate.read_mesh().faces) == 12
    parts = bell.read_parts(len(bell.read_mesh().faces))
    assert set(parts.tolist()) == {NO_PART, *range(bell.parts)}
    assert np.count_nonzero(parts == NO_PART) == 1


def test_a_limit_spreads_the_assets_over_the_whole_list(assets: Path) -> None:
    assert [asset.name for asset in read_assets(assets, 1)] == ["crate"]
    assert len(read_assets(assets, 9)) == 2
    with pytest.raises(BenchmarkError, match="at least 1 model"):
        read_assets(assets, 0)


def test_an_error_names_the_file_that_does_not_fit(assets: Path) -> None:
    crate = read_assets(assets)[0]
    with pytest.raises(BenchmarkError, match=r"crate\.seg must have one label for each of 13 faces, not 12"):
        crate.read_parts(13)
    crate.mesh_path.unlink()
    with pytest.raises(BenchmarkError, match="Model props/crate cannot be read"):
        crate.read_mesh()
    for table, message in (("set\tname\n", "lists no model"), ("set\tname\na\tb\n", "columns set, name, parts")):
        (assets / "models.tsv").write_text(table)
        with pytest.raises(BenchmarkError, match=message):
            read_assets(assets)
    with pytest.raises(BenchmarkError, match="is not the folder of the assets"):
        read_assets(assets / "props")
