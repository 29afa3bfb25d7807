"""The npm packages of the repository as npm packs them, and an app in a fresh folder that uses them."""

import shutil
import subprocess
from pathlib import Path

from helpers.documents import ROOT
from helpers.node import programs

_PACKAGES = ("viewer", "integrations/client-js")
_NEEDED = ("LICENSE", "docs/openapi.json")  # what their scripts read outside of their folders
_BUILT = shutil.ignore_patterns("node_modules", "dist", "schema.ts", "LICENSE")


def packed(folder: Path) -> list[Path]:
    """Build and pack the packages in copies of their folders; return their archives."""
    for name in _NEEDED:
        (folder / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, folder / name)
    for name in _PACKAGES:
        shutil.copytree(ROOT / name, folder / name, ignore=_BUILT)
        npm(folder / name, "ci", "--ignore-scripts")
        npm(folder / name, "pack", "--pack-destination", str(folder))
    return sorted(folder.glob("*.tgz"))


def consumer(folder: Path) -> Path:
    """Return a folder with the programs of tests/helpers/node/consumer and the packages that they use."""
    app, build = folder / "app", folder / "packages"
    app.mkdir()
    build.mkdir()
    programs.install("consumer", app)
    npm(app, "install", "--no-save", "--ignore-scripts", *map(str, packed(build)))
    return app


def bundled(app: Path, program: str) -> str:
    """Return a program of the app with everything that it imports, as one script for a page."""
    command = ["node", "node_modules/esbuild/bin/esbuild", program, "--bundle", "--format=esm", "--log-level=warning"]
    done = subprocess.run(command, cwd=app, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def npm(folder: Path, *arguments: str) -> None:
    command = ["npm", *arguments, "--no-audit", "--no-fund", "--loglevel=error"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
