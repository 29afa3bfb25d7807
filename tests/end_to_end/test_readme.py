"""The examples of the README, the first steps and the guide for pages work as pasted."""

import shutil
import sys
from pathlib import Path

import pytest

from helpers.documents import ADDRESS, block, run, shell
from helpers.installation import Installation

README = Path("README.md")
FIRST_STEPS = Path("docs/first-steps.md")
FRONTEND = Path("docs/how-to/frontend.md")


def test_the_walk_through_with_curl_works_as_pasted_and_so_do_the_ways_without_a_server(tmp_path: Path) -> None:
    if shutil.which("curl") is None or shutil.which("bash") is None:
        pytest.skip("the walk-through needs bash and curl")
    with Installation(workers=1) as installation:
        first = run(shell(block(README, "sh", "curl").replace(ADDRESS, installation.url)), tmp_path)
        printed = run(shell(block(FIRST_STEPS, "sh", "curl").replace(ADDRESS, installation.url)), tmp_path)
        check_the_clients(installation.url, tmp_path)
    assert '"segments":7,' in first.replace(" ", "")
    assert '{"segments":7,' in printed.replace(" ", "")
    assert '{"segments":4,' in printed.replace(" ", "")
    assert '"automatic_segments":7' in printed.replace(" ", "")
    assert (tmp_path / "parts.png").read_bytes()[1:4] == b"PNG"
    assert len(set((tmp_path / "jack.seg").read_text().split())) == 7

    (tmp_path / "parts.glb").unlink()
    assert "7" in run(shell(block(README, "sh", "cleave segment")), tmp_path)
    assert (tmp_path / "parts.glb").read_bytes()[:4] == b"glTF"
    assert len(set((tmp_path / "labels.seg").read_text().split())) == 7
    assert (tmp_path / "tree.json").exists()

    python = block(README, "python", "segcore") + "\nassert len(set(hierarchy.labels(7))) == 7"
    run([sys.executable, "-c", python], tmp_path)

    assert "faces" in run(shell(block(FIRST_STEPS, "sh", "cleave convert")), tmp_path)
    assert (tmp_path / "jack.glb").read_bytes()[:4] == b"glTF"
    assert (tmp_path / "jack-9.ply").read_bytes()[:3] == b"ply"


def check_the_clients(url: str, folder: Path) -> None:
    """Use a running service in the other ways, in a folder with jack.ply."""
    (folder / "parts.glb").unlink()
    python = block(FIRST_STEPS, "python", "cleave.client").replace(ADDRESS, url)
    assert run([sys.executable, "-c", python], folder).startswith("7 [")
    assert (folder / "parts.glb").read_bytes()[:4] == b"glTF"

    run(shell(f"{block(FIRST_STEPS, 'sh', 'cleave submit').strip()} --server {url}"), folder)
    labels = (folder / "results" / "jack.seg").read_text().split()
    assert len(set(labels)) == 7

    if shutil.which("node"):
        (folder / "jack.mjs").write_text(block(FRONTEND, "js", "await fetch(`").replace(ADDRESS, url))
        segments, faces, _ = run(["node", "jack.mjs"], folder).split()
        assert (segments, int(faces)) == ("7", len(labels))


def test_the_two_commands_are_in_the_readme() -> None:
    assert block(README, "sh", "cleave serve") == "pip install . && cleave serve\n"
    assert block(README, "sh", "pytest") == "pip install '.[test]' && pytest\n"
