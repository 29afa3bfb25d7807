"""The README's examples do what they say, as pasted."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cleave.settings import Settings
from helpers.installation import Installation

ADDRESS = "http://127.0.0.1:8000"
README = Path(__file__).parents[2] / "README.md"
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", README.read_text(), re.DOTALL)


def block(language: str, mark: str) -> str:
    """The only block of code in a language that has a mark."""
    (text,) = [text for name, text in BLOCKS if name == language and mark in text]
    return str(text)


def run(command: list[str], folder: Path) -> str:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    python_path = f"{README.parent}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    environment = os.environ | {"PATH": path, "PYTHONPATH": python_path}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=240, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_walk_through_with_curl_works_as_pasted_and_so_do_the_ways_without_a_server(tmp_path: Path) -> None:
    if shutil.which("curl") is None or shutil.which("bash") is None:
        pytest.skip("the walk-through needs bash and curl")
    walk = block("sh", "curl")
    with Installation(workers=1) as installation:
        printed = run(["bash", "-euc", walk.replace(ADDRESS, installation.url)], tmp_path)
        check_the_clients(installation.url, tmp_path)
    assert '{"segments":7,' in printed.replace(" ", "")
    assert '{"segments":4,' in printed.replace(" ", "")
    assert '"automatic_segments":7' in printed.replace(" ", "")
    assert (tmp_path / "parts.png").read_bytes()[1:4] == b"PNG"
    assert len(set((tmp_path / "burr.seg").read_text().split())) == 7

    (tmp_path / "parts.glb").unlink()
    segment = block("sh", "cleave segment").replace("cleave segment", f"{sys.executable} -m service.commands segment")
    assert "7" in run(["bash", "-euc", segment], tmp_path)
    assert (tmp_path / "parts.glb").read_bytes()[:4] == b"glTF"
    assert len(set((tmp_path / "labels.seg").read_text().split())) == 7
    assert (tmp_path / "tree.json").exists()

    run([sys.executable, "-c", block("python", "segcore") + "\nassert len(set(hierarchy.labels(7))) == 7"], tmp_path)


def check_the_clients(url: str, folder: Path) -> None:
    """The other ways to use a running service, in a folder with burr.stl."""
    (folder / "parts.glb").unlink()
    python = block("python", "cleave.client").replace(ADDRESS, url)
    assert run([sys.executable, "-c", python], folder).startswith("7 [")
    assert (folder / "parts.glb").read_bytes()[:4] == b"glTF"

    submit = block("sh", "cleave submit").replace("cleave submit", f"{sys.executable} -m service.commands submit")
    run(["bash", "-euc", f"{submit.strip()} --server {url}"], folder)
    assert len(set((folder / "results" / "burr.seg").read_text().split())) == 7

    if shutil.which("node"):
        (folder / "burr.mjs").write_text(block("js", "fetch").replace(ADDRESS, url))
        segments, faces, _ = run(["node", "burr.mjs"], folder).split()
        assert (segments, int(faces)) == ("7", len((folder / "results" / "burr.seg").read_text().split()))


def test_the_two_commands_are_in_the_readme() -> None:
    assert block("sh", "cleave serve") == "pip install . && cleave serve\n"
    assert block("sh", "pytest") == "pip install '.[test]' && pytest\n"


def test_the_table_of_settings_is_complete_and_true() -> None:
    rows = dict(re.findall(r"^\| `(CLEAVE_\w+)` \| .*? \| (.*) \|$", README.read_text(), re.MULTILINE))
    defaults = dict(re.findall(r"^\| `(CLEAVE_\w+)` \| (.*?) \|", README.read_text(), re.MULTILINE))
    fields = {f"CLEAVE_{name.upper()}": field for name, field in Settings.model_fields.items()}
    assert rows == {name: field.description for name, field in fields.items()}
    for name, field in fields.items():
        if field.default_factory is None:
            value = field.get_default()
            assert defaults[name].split(" (")[0] == ("none" if value is None else str(value))
