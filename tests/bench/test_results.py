"""bench/RESULTS.md: its commands exist with their options, and its table of contents has every section."""

import re
import shlex
from pathlib import Path

import pytest

from bench.__main__ import command_names, parser_of

ROOT = Path(__file__).parents[2]
RESULTS = (ROOT / "bench" / "RESULTS.md").read_text(encoding="utf-8")
MODEL_CARD = (ROOT / "docs" / "explanation" / "learned-models.md").read_text(encoding="utf-8")


def commands(text: str) -> list[str]:
    """Return the arguments of every `python -m bench` in a block or in code font."""
    blocks = re.findall(r"^    .*python -m bench (.*)$", text, re.MULTILINE)
    return [*blocks, *re.findall(r"`python -m bench ([^`]*)`", text)]


def anchor(heading: str) -> str:
    """Return the anchor of a heading on GitHub."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


@pytest.mark.parametrize("line", dict.fromkeys([*commands(RESULTS), *commands(MODEL_CARD)]))
def test_every_command_exists_with_its_options(line: str) -> None:
    name, *arguments = shlex.split(line.partition("[...]")[0], comments=True)
    if arguments and name != "COMMAND":
        parser_of(name).parse_args(arguments)
    assert name in [*command_names(), "COMMAND"]


def test_every_command_is_named() -> None:
    assert [name for name in command_names() if not re.search(rf"bench {name}\b|`{name}`", RESULTS)] == []


def test_the_table_of_contents_links_to_every_section() -> None:
    headings = re.findall(r"^## (.*)$", RESULTS, re.MULTILINE)
    links = re.findall(r"^\| \[(.*)\]\(#(.*)\) \| `python -m bench ", RESULTS, re.MULTILINE)
    assert links == [(heading, anchor(heading)) for heading in headings]
