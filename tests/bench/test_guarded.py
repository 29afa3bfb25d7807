"""Programs that answer lines: they may die or hang, and answer the next line all the same."""

import sys

import pytest

from bench import guarded
from bench.guarded import Guarded

PROGRAM = """
import json, os, sys, time
for line in sys.stdin:
    if line == "die\\n":
        os._exit(1)
    if line == "hang\\n":
        time.sleep(600)
    print(json.dumps({"line": line, "by": os.getpid()}), flush=True)
"""


def test_a_program_that_died_or_hangs_is_started_again(monkeypatch: pytest.MonkeyPatch) -> None:
    with Guarded([sys.executable, "-c", PROGRAM]) as program:
        first = program.ask("a")
        assert first["line"] == "a\n"
        assert program.ask("größe\udcff") == {"line": "größe\udcff\n", "by": first["by"]}
        assert program.ask("die") == {"error": "the program died"}
        monkeypatch.setattr(guarded, "MOST_SECONDS", 0.2)
        assert program.ask("hang") == {"error": "no answer in 0.2 s"}
        monkeypatch.undo()
        assert program.ask("b")["line"] == "b\n"
