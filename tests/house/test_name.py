"""The distribution is called cleave-mesh: no text says to install the other distribution with the plain name."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PLAIN = re.compile(
    r"""
    (?<![\w-]) cleave \[                                           # an extra of it
    | (\binstall|\b(uv|poetry|pdm)\ add|\buvx|\bpipx\ (run|inject))
      (\s+-\S+)*                                                   # options
      \s+ ["'`]? cleave (?![\w.-])
    """,
    re.VERBOSE,
)


def plain_names(text: str) -> list[str]:
    """Return every instruction to install the distribution with the plain name, with its line number."""
    return [f"{text.count(chr(10), 0, found.start()) + 1}: {found[0]}" for found in PLAIN.finditer(text)]


def tracked_texts() -> dict[str, str]:
    """Return the tracked text files by their path."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    texts = {}
    for name in listed.split("\0"):
        path = ROOT / name
        content = path.read_bytes() if name and path.is_file() else b"\0"
        if b"\0" not in content:
            texts[name] = content.decode("utf-8", errors="replace")
    return texts


def test_no_text_says_to_install_the_plain_name() -> None:
    texts = tracked_texts()
    assert {"README.md", "Dockerfile", "pyproject.toml"} <= texts.keys()
    assert [f"{name}:{line}" for name, text in texts.items() for line in plain_names(text)] == []


# The name is filled in, so that the test above does not find this file.
@pytest.mark.parametrize(
    "line",
    [
        "pip install {}",
        "pip3 install -U --pre {}",
        "pip install '{}[cloud]'",
        'pip install "{}==0.1"',
        "pip install\n    {}",
        "run `uv add {}`",
        "uv pip install {}>=0.1",
        "uvx {} serve",
        "pipx run {}",
        "RUN pip install --no-cache-dir {}",
        'test = ["{}[cloud,draco]"]',
        "the extra {}[cloud]",
    ],
)
def test_an_instruction_with_the_plain_name_is_found(line: str) -> None:
    found = plain_names("first line\n" + line.format("cleave"))
    assert len(found) == 1
    assert found[0].startswith("2: ")


@pytest.mark.parametrize(
    "line",
    [
        "pip install cleave-mesh",
        "pip install 'cleave-mesh[cloud]'",
        "pip install . && cleave serve",
        "pip install ./cleave",
        "uvx --from cleave-mesh cleave serve",
        "pip uninstall cleave",
        "import cleave",
    ],
)
def test_other_uses_of_the_name_are_not_found(line: str) -> None:
    assert plain_names(line) == []
