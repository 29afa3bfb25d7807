"""An app that has installed the packages as npm packs them."""

from pathlib import Path

import pytest

from helpers.node import packages


@pytest.fixture(scope="package")
def app(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return packages.consumer(tmp_path_factory.mktemp("packages"))
