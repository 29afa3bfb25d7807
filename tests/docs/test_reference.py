"""The references of the settings and of the command line are those of the code."""

import re
from pathlib import Path

from cleave.settings import Settings
from docs.reference.generate import commands_page, parsers, settings_page
from helpers.documents import read

RENEW = "run python -m docs.reference.generate, and commit what changed"
SETTINGS = Path("docs/reference/settings.md")
COMMANDS = Path("docs/reference/cli.md")


def test_the_committed_references_are_current() -> None:
    assert read(SETTINGS) == settings_page(), RENEW
    assert read(COMMANDS) == commands_page(), RENEW


def test_the_table_of_settings_is_complete_and_true() -> None:
    rows = re.findall(r"^\| `(CLEAVE_\w+)` \| (.*?) \| (.*?) \| (.*) \|$", read(SETTINGS), re.MULTILINE)
    fields = {f"CLEAVE_{name.upper()}": field for name, field in Settings.model_fields.items()}
    assert {name: meaning for name, _, _, meaning in rows} == {name: f.description for name, f in fields.items()}
    assert len(rows) == len(fields)
    for name, _, default, _ in rows:
        if fields[name].default_factory is None:
            value = fields[name].get_default()
            assert default.split(" (")[0] == ("none" if value is None else str(value))


def test_every_option_of_every_command_is_listed() -> None:
    for name, parser in parsers().items():
        section = read(COMMANDS).partition(f"## `cleave {name}`\n")[2].partition("\n## ")[0]
        for action in parser._actions:
            assert all(f"`{option}`" in section for option in action.option_strings if action.dest != "help")
