"""Extras come from the metadata of the distribution, so that a new one is known without a change."""

import re
import tomllib
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from service.doctor.extras import _OF_DEVELOPERS, missing_extras

ROOT = Path(__file__).parents[3]
_METADATA = """Metadata-Version: 2.4
Name: some-tool
Version: 1.0
Requires-Dist: not-there>=1
Requires-Dist: numpy>=2; extra == "arrays"
Requires-Dist: not-there>=2; extra == "far"
Requires-Dist: numpy; extra == "half"
Requires-Dist: not-there; extra == "half"
Requires-Dist: not-there; platform_system == "Windows" and extra == "elsewhere"
Requires-Dist: not-there; extra == "test"
"""


def test_extras_with_a_package_that_is_not_installed_are_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "some_tool-1.0.dist-info").mkdir()
    (tmp_path / "some_tool-1.0.dist-info" / "METADATA").write_text(_METADATA)
    monkeypatch.syspath_prepend(tmp_path)
    assert missing_extras("some-tool") == ["far", "half"]


def test_a_distribution_that_is_not_installed_is_refused() -> None:
    with pytest.raises(PackageNotFoundError):
        missing_extras("not-there")


def test_the_tests_install_every_extra_of_users_and_the_guide_explains_it() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    (own,) = [line for line in extras["test"] if line.startswith(f"{project['name']}[")]
    of_users = extras.keys() - _OF_DEVELOPERS
    assert set(own.partition("[")[2].rstrip("]").split(",")) == of_users
    guide = (ROOT / "docs" / "how-to" / "operations.md").read_text()
    table = guide.partition("### Extras")[2].partition("\n#")[0]
    assert set(re.findall(r"^\| `(\w+)`", table, re.MULTILINE)) == of_users
