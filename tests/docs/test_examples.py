"""What the documents name is there: commands and their options, settings, files."""

import argparse
import re
import shlex
from pathlib import Path

import pytest

from cleave.settings import Settings
from docs.reference.generate import parsers
from helpers.documents import ROOT, blocks, code_spans, documents, read

# Variables that are no settings of the service: of Compose, of a client, of the tests and the benchmark.
_OTHER_VARIABLES = {
    "REDIS_PASSWORD",
    "STORE_PASSWORD",
    "API_KEY",
    "FUZZ_SECONDS",
    "PSB_DIR",
    "PSB_VECTORS",
    "ASSETS_DIR",
}
_FOLDERS = ("bench", "cleave", "deploy", "docs", "segcore", "service", "tests", "viewer", "worker")
# History names what there was.
_OF_TODAY = [path for path in documents() if path.name != "CHANGELOG.md"]


def commands_in(text: str) -> list[list[str]]:
    """Return the words of every call of ``cleave`` in the shell blocks and code spans of a document."""
    shell = "\n".join(blocks(text, "sh")).replace("\\\n", " ")
    lines = [line for line in shell.splitlines() if not line.lstrip().startswith("#")] + code_spans(text)
    calls = [re.search(r"(?:^|&& |\$\(|=\S+ |service )cleave ([a-z-].*)", line) for line in lines]
    return [shlex.split(re.split(r" (?:\||&&) ", call[1])[0], posix=False) for call in calls if call]


def complaints(words: list[str], known: dict[str, argparse.ArgumentParser]) -> list[str]:
    """Return the command or the options in a call that do not exist."""
    command, *rest = words
    if command.startswith("--"):
        return [] if command.strip("[]") in ("--version", "--help") else [command]
    if command not in known:
        return [command]
    options = known[command]._option_string_actions
    return [word for word in rest if word.strip("[]").startswith("-") and word.strip("[]") not in options]


@pytest.mark.parametrize("document", _OF_TODAY, ids=str)
def test_every_command_uses_options_that_exist(document: Path) -> None:
    known = parsers()
    calls = commands_in(read(document))
    assert [found for words in calls for found in complaints(words, known)] == []


def test_an_option_that_does_not_exist_is_found() -> None:
    text = "```sh\npip install . && cleave serve --prot 8000\n```\n`cleave submit a.off --again`, `cleave liszt`\n"
    calls = commands_in(text)
    assert [words[0] for words in calls] == ["serve", "submit", "liszt"]
    assert [found for words in calls for found in complaints(words, parsers())] == ["--prot", "liszt"]


@pytest.mark.parametrize("document", _OF_TODAY, ids=str)
def test_every_setting_that_is_named_exists(document: Path) -> None:
    known = {name.upper() for name in Settings.model_fields} | _OTHER_VARIABLES
    assert set(re.findall(r"\bCLEAVE_([A-Z][A-Z_]+)\b", read(document))) <= known


@pytest.mark.parametrize("document", _OF_TODAY, ids=str)
def test_every_file_that_is_named_exists(document: Path) -> None:
    named = [span for span in code_spans(read(document)) if re.fullmatch(rf"({'|'.join(_FOLDERS)})/[\w./-]*", span)]
    assert [path for path in named if not (ROOT / path).exists()] == []
