"""The zip of the Blender extension: the same bytes each time, with a manifest that Blender accepts."""

import re
import subprocess
import sys
import tomllib
import zipfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from helpers.blender.session import needs_blender
from helpers.documents import ROOT
from integrations.blender_package import pack

# https://docs.blender.org/manual/en/4.2/advanced/extensions/getting_started.html
_REQUIRED = {
    "schema_version",
    "id",
    "version",
    "name",
    "tagline",
    "maintainer",
    "type",
    "blender_version_min",
    "license",
}
_LONGEST = 64  # characters of texts without a full stop


@pytest.fixture(scope="module")
def manifest() -> dict[str, Any]:
    return tomllib.loads((ROOT / "integrations/blender/blender_manifest.toml").read_text())


def test_the_manifest_follows_the_rules(manifest: dict[str, Any]) -> None:
    assert set(manifest) >= _REQUIRED
    assert manifest["schema_version"] == "1.0.0"
    assert manifest["id"].isidentifier()
    assert "__" not in manifest["id"]
    assert manifest["type"] == "add-on"
    assert re.fullmatch(r"\d+\.\d+\.\d+", manifest["blender_version_min"])
    assert manifest["license"] == ["SPDX:MIT"]
    texts = [manifest["tagline"], *manifest["permissions"].values()]
    assert all(len(text) <= _LONGEST and text[-1].isalnum() for text in texts)
    assert set(manifest["permissions"]) <= {"files", "network", "clipboard", "camera", "microphone"}


def test_the_version_is_that_of_the_product(manifest: dict[str, Any]) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert manifest["version"] == project["version"]


def test_the_zip_has_the_same_bytes_each_time(tmp_path: Path, manifest: dict[str, Any]) -> None:
    first, second = pack(tmp_path / "a"), pack(tmp_path / "b")
    assert first.name == f"{manifest['id']}-{manifest['version']}.zip"
    assert first.read_bytes() == second.read_bytes()


def test_the_zip_has_the_sources_and_the_licence(tmp_path: Path) -> None:
    with zipfile.ZipFile(pack(tmp_path)) as archive:
        packed = archive.namelist()
        assert archive.read("LICENSE") == (ROOT / "LICENSE").read_bytes()
        assert archive.read("ui/panel.py") == (ROOT / "integrations/blender/ui/panel.py").read_bytes()
    assert packed == sorted(packed)
    assert {"__init__.py", "blender_manifest.toml", "colors.txt", "local_program.py"} <= set(packed)
    assert not [name for name in packed if "__pycache__" in name or name.endswith(".md")]


@needs_blender
def test_blender_accepts_the_manifest_and_packs_the_same_files(tmp_path: Path) -> None:
    spec = find_spec("bpy")
    assert spec is not None
    assert spec.origin is not None
    (program,) = Path(spec.origin).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    sources = ROOT / "integrations" / "blender"
    ours = pack(tmp_path / "ours")
    for arguments in (["validate", str(ours)], ["build", "--source-dir", str(sources), "--output-dir", str(tmp_path)]):
        done = subprocess.run([sys.executable, str(program), *arguments], capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stdout + done.stderr
    assert names(tmp_path / ours.name) == names(ours) - {"LICENSE"}


def names(archive: Path) -> set[str]:
    with zipfile.ZipFile(archive) as opened:
        return set(opened.namelist())
