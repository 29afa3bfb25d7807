"""The Markdown documents of the repository."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
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
