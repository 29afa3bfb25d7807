"""Types that openapi-typescript makes from the OpenAPI document are exact."""

import subprocess
from pathlib import Path

from helpers.node import programs
from service.openapi.export import DOCS

COMPILE = "--noEmit --strict --target es2022 --lib es2022,dom --module esnext --moduleResolution bundler"


def test_generated_types_are_exact_for_the_newest_typescript(tmp_path: Path) -> None:
    folder = programs.install("types", tmp_path)
    packages = folder / "node_modules"
    programs.run(
        packages / "openapi-typescript/bin/cli.js", [str(DOCS / "openapi.json"), "-o", str(folder / "api.d.ts")]
    )
    command = ["node", str(packages / "typescript-newest/bin/tsc"), *COMPILE.split(), str(folder / "exact.ts")]
    compiled = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert compiled.returncode == 0, compiled.stdout
