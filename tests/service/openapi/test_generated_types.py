"""Types for TypeScript: those that openapi-typescript makes from the OpenAPI document, and those of <cleave-viewer>."""

import shutil
import subprocess
from importlib.resources import files
from pathlib import Path

import pytest

from helpers.documents import blocks
from helpers.node import programs
from service.openapi.export import DOCS

COMPILE = "--noEmit --strict --target es2022 --lib es2022,dom --module esnext --moduleResolution bundler"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return programs.install("types", tmp_path_factory.mktemp("types"))


def complaints(folder: Path, name: str) -> str:
    """Return what the newest TypeScript says about a file."""
    command = ["node", str(folder / "node_modules/typescript-newest/bin/tsc"), *COMPILE.split(), str(folder / name)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False).stdout


@pytest.fixture(scope="module")
def generated(folder: Path) -> Path:
    """The folder with the generated types, cleave.d.ts."""
    generator = folder / "node_modules/openapi-typescript/bin/cli.js"
    arguments = [str(DOCS / "openapi.json"), "--default-non-nullable=false", "-o", str(folder / "cleave.d.ts")]
    programs.run(generator, arguments)
    return folder


def test_types_made_from_the_document_are_exact(generated: Path) -> None:
    assert complaints(generated, "exact.ts") == ""


def test_the_example_of_the_guide_compiles(generated: Path) -> None:
    guide = blocks((DOCS / "how-to" / "frontend.md").read_text(), "ts")
    (example,) = (block for block in guide if "openapi-fetch" in block)
    (generated / "example.ts").write_text(example)
    assert complaints(generated, "example.ts") == ""


def test_the_types_of_the_component_are_exact(folder: Path) -> None:
    shutil.copy(str(files("service").joinpath("viewer", "cleave-viewer.d.ts")), folder)
    assert complaints(folder, "component.ts") == ""
