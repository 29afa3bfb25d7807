"""The Markdown documents of the repository, and their blocks of code as somebody runs them who pastes them."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
ADDRESS = "http://127.0.0.1:8000"  # of the service in the documents
_SKIPPED = {"node_modules", "build", "dist"}
_FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def documents() -> list[Path]:
    """Return all Markdown files, except those of installed packages and in hidden folders."""
    found = [path.relative_to(ROOT) for path in ROOT.rglob("*.md")]
    return sorted(path for path in found if not any(part in _SKIPPED or part.startswith(".") for part in path.parts))


def read(path: Path) -> str:
    return (ROOT / path).read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    """Return the fenced blocks of code in a language."""
    return [code for name, code in _FENCE.findall(text) if name == language]


def without_code(text: str) -> str:
    """Return the text without its fenced blocks and code spans."""
    return re.sub(r"`[^`\n]*`", "", _FENCE.sub("", text))


def code_spans(text: str) -> list[str]:
    """Return what stands between single backticks, outside of fenced blocks."""
    return re.findall(r"`([^`\n]+)`", _FENCE.sub("", text))


def block(document: Path, language: str, mark: str) -> str:
    """Return the only block of code in a language that contains a mark."""
    (text,) = [text for text in blocks(read(document), language) if mark in text]
    return text


def shell(text: str) -> list[str]:
    """Return the command that runs shell lines, with the ``cleave`` of this checkout."""
    return ["bash", "-euc", re.sub(r"^cleave ", f"{sys.executable} -m service.commands ", text, flags=re.MULTILINE)]


def run(command: list[str], folder: Path) -> str:
    """Run a command in a folder, with the packages of this checkout, and return what it prints."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    python_path = f"{ROOT}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    environment = os.environ | {"PATH": path, "PYTHONPATH": python_path}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=240, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
