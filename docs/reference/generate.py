"""Writes docs/reference/settings.md and docs/reference/cli.md from the code: ``python -m docs.reference.generate``."""

import argparse
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cleave.settings import Settings
from service.commands import main as command_line

FOLDER = Path(__file__).parent

# The first setting of each section; the order within is that of the class.
_SECTIONS = {
    "data_dir": "Data and retention",
    "redis_url": "Queue",
    "auth": "Access and quotas",
    "max_wait_s": "Requests and uploads",
    "max_uncompressed_bytes": "Meshes",
    "large_job_bytes": "Jobs and workers",
    "result_cache_bytes": "Caches of the service",
    "log_level": "Logs",
}
_SETTINGS = """\
# Settings

Settings are environment variables. Each process reads them when it starts, and all processes of an installation must
get the same ones. An empty variable counts as unset, and a value that is not valid is an error that names the variable.
`cleave serve --help` prints the list, too.

Sizes are in bytes and times in seconds.
"""
_OTHERS = """
## Variables of other programs

- `CLEAVE_API_KEY`: the API key that `cleave submit` sends.
- `NUMBA_CACHE_DIR`: the folder of the compiled kernels, set by the container image. If Cleave cannot write its kernels
  there or into its own installation, it uses the folder `kernels` of the data folder.
- `AWS_ACCESS_KEY_ID` and others: credentials of the bucket, see [Operations](../how-to/operations.md#the-store).
"""
_HEAD_OF_SETTINGS = ("| variable | values | default | meaning |", "|---|---|---|---|")
_HEAD_OF_ARGUMENTS = ("| argument | default | meaning |", "|---|---|---|")
_COMMANDS = """\
# Command line

`cleave` has one subcommand per task; `cleave COMMAND --help` prints what this page lists. `cleave --version` prints the
version.

## Exit status

An expected error, such as a file that cannot be read, is one line on standard error and exit status 2. Ctrl-C ends a
command with exit status 130, except `serve` and `worker`, which end with 0. A traceback and status 1 are an error in
Cleave.

"""


def settings_page() -> str:
    """Return the reference of the environment variables."""
    return _SETTINGS + "".join(f"{line}\n" for line in _settings_tables()) + _OTHERS


def commands_page() -> str:
    """Return the reference of the command line."""
    return _COMMANDS + "".join(f"{line}\n" for line in (*_exit_statuses(), *_command_sections()))


def parsers() -> dict[str, argparse.ArgumentParser]:
    """Return the parser of every subcommand, by name."""
    return {name: _subparser(name) for name in command_line.COMMANDS}


def _subparser(name: str) -> argparse.ArgumentParser:
    actions = command_line._parser([name])._actions
    (commands,) = (action for action in actions if isinstance(action, argparse._SubParsersAction))
    parser: argparse.ArgumentParser = commands.choices[name]
    return parser


def _settings_tables() -> Iterator[str]:
    schema = Settings.model_json_schema()["properties"]
    for name, field in Settings.model_fields.items():
        if name in _SECTIONS:
            yield from (
                "",
                f"## {_SECTIONS[name]}",
                "",
                "| variable | values | default | meaning |",
                "|---|---|---|---|",
            )
        default = "the user's data folder" if field.default_factory else _default(name, field.get_default())
        yield f"| `CLEAVE_{name.upper()}` | {_values(schema[name])} | {default} | {field.description} |"


def _default(name: str, value: object) -> str:
    if value is None:
        return "none"
    size = _binary_size(value) if name.endswith("_bytes") and isinstance(value, int) else ""
    return f"{value}{size}"


def _binary_size(value: int) -> str:
    for unit, size in (("GiB", 2**30), ("MiB", 2**20)):
        if value % size == 0 and value:
            return f" ({value // size} {unit})"
    return ""


def _values(schema: dict[str, Any]) -> str:
    """Describe the values that a JSON Schema allows."""
    schema = schema | next((one for one in schema.get("anyOf", []) if one["type"] != "null"), {})
    if choices := schema.get("enum") or re.findall(r"\w+", schema.get("pattern", "")):
        ending = "://…" if "://" in schema.get("pattern", "") else ""
        return ", ".join(f"{choice}{ending}" for choice in choices)
    kind = {"string": "path" if schema.get("format") == "path" else "text", "boolean": "True, False"}
    limits = [
        f"{sign} {schema[key]:g}" if schema[key] < 10_000 else f"{sign} {schema[key]}"
        for key, sign in (("minimum", "≥"), ("exclusiveMinimum", ">"), ("maximum", "≤"))
        if key in schema
    ]
    return " ".join([kind.get(schema["type"], schema["type"]), " and ".join(limits)]).strip()


def _command_sections() -> Iterator[str]:
    for name, parser in parsers().items():
        yield from ("", f"## `cleave {name}`", "", _sentence(parser.description or ""), "", *_HEAD_OF_ARGUMENTS)
        yield from (_argument(action) for action in parser._actions if action.dest != "help")
        if (parser.epilog or "").startswith("settings"):
            yield from ("", "Everything else is a [setting](settings.md) in the environment.")


def _exit_statuses() -> Iterator[str]:
    columns = sorted({status for statuses in command_line.EXIT_STATUSES.values() for status in statuses})
    yield from (f"| command | {' | '.join(map(str, columns))} |", "|---" * (len(columns) + 1) + "|")
    for name, statuses in command_line.EXIT_STATUSES.items():
        cells = (_sentence(statuses[status]) if status in statuses else "" for status in columns)
        yield f"| `{name}` | {' | '.join(cells)} |"


def _argument(action: argparse.Action) -> str:
    if action.option_strings:
        name = ", ".join(f"`{option}`" for option in action.option_strings) + _value_name(action)
    else:
        name = f"`{action.metavar}`" + (" ..." if action.nargs == "+" else "")
    has_default = action.default not in (None, False, [])
    default = action.default if not isinstance(action.default, tuple) else ",".join(action.default)
    help_text = re.sub(r" \((?:%\(default\)s|here|seg,json,glb)\)$", "", action.help or "")
    return f"| {name} | {default if has_default else ''} | {_sentence(help_text)} |"


def _value_name(action: argparse.Action) -> str:
    if action.nargs == 0:
        return ""
    if action.choices is not None:
        return f" {', '.join(map(str, action.choices))}"
    return f" `{action.metavar or action.dest.upper()}`"


def _sentence(text: str) -> str:
    text = " ".join(text.split())
    return f"{text[:1].upper()}{text[1:]}{'' if text.endswith('.') else '.'}"


if __name__ == "__main__":
    (FOLDER / "settings.md").write_text(settings_page(), encoding="utf-8")
    (FOLDER / "cli.md").write_text(commands_page(), encoding="utf-8")
