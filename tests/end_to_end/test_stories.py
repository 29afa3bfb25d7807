"""The stories of the guides work as pasted: a print in four colours, and a data set."""

import json
import shutil
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from cleave.client import Client
from helpers.documents import ADDRESS, block, run, shell
from helpers.installation import Installation
from segcore import read_mesh

PRINTING = Path("docs/how-to/printing.md")
DATASET = Path("docs/how-to/label-a-dataset.md")
SAMPLES = {"dumbbell", "jack", "pawn", "stool"}


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    if shutil.which("curl") is None or shutil.which("bash") is None:
        pytest.skip("the stories need bash and curl")
    with Installation(workers=1) as installation:
        yield installation.url


def test_a_figure_is_printed_in_four_colours(url: str, tmp_path: Path) -> None:
    printed = run(shell(block(PRINTING, "sh", "samples/pawn.ply").replace(ADDRESS, url)), tmp_path)
    assert "5 segments, chosen automatically" in printed
    assert "5 objects, 4 filaments" in printed
    model = zipfile.ZipFile(tmp_path / "pawn.3mf").read("3D/3dmodel.model").decode()
    assert model.count("<base ") == 4
    if shutil.which("prusa-slicer"):
        changes = run(shell(block(PRINTING, "sh", "prusa-slicer")), tmp_path)
        assert int(changes.splitlines()[-1]) >= 4
        lines = (tmp_path / "pawn.gcode").read_text().splitlines()
        assert {f"T{tool}" for tool in range(4)} <= set(lines)


def test_a_folder_of_meshes_becomes_a_data_set(url: str, tmp_path: Path) -> None:
    run(shell(block(DATASET, "sh", "classes.txt").replace(ADDRESS, url)), tmp_path)
    submit = block(DATASET, "sh", "cleave submit").replace("cleave submit", f"cleave submit --server {url}")
    run(shell(submit), tmp_path)
    assert {path.stem for path in (tmp_path / "automatic").glob("*.npy")} == SAMPLES

    guess = block(DATASET, "python", '"op": "class"').replace(ADDRESS, url)
    run([sys.executable, "-c", guess], tmp_path)
    with Client(url) as client:
        (jack,) = [job for job in client.jobs("succeeded") if job.file_name == "jack.ply"]
        client.put_labels(jack.id, client.labels(jack, segments=2).labels)
        client.edit(jack.id, [{"op": "class", "part": 1, "class": "limb"}])
    run([sys.executable, "-c", block(DATASET, "python", "np.savetxt").replace(ADDRESS, url)], tmp_path)

    classes = {name: np.load(tmp_path / "labels" / f"{name}.npy") for name in SAMPLES}
    for name, found in classes.items():
        assert len(found) == len(read_mesh(tmp_path / "meshes" / f"{name}.ply").faces)
        points = np.loadtxt(tmp_path / "points" / f"{name}.txt")
        assert points.shape == (2048, 7)
        assert set(points[:, 6]) == set(found)
        assert np.allclose(np.linalg.norm(points[:, 3:6], axis=1), 1, atol=1e-5)
        parts = json.loads(zipfile.ZipFile(tmp_path / "parts" / f"{name}.zip").read("parts.json"))["parts"]
        assert sum(part["faces"] for part in parts) == len(found)
    assert set(classes["stool"]) == {1, 2}
    assert set(classes["jack"]) == {0, 2}  # a part of it has no class
