"""Guarded: a program that answers lines with lines of JSON, and is started again after it died or took too long."""

from __future__ import annotations

import json
import os
import select
import subprocess
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Any

MOST_SECONDS = 60  # for one line, set by hand


class Guarded:
    """A program in a process of its own."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str] | None = None) -> None:
        self._command = command
        self._environment = environment
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> Guarded:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()

    def ask(self, line: str) -> dict[str, Any]:
        """Return the answer to a line, or ``{"error": ...}`` if the program died or took too long."""
        if self._process is None:
            self._process = subprocess.Popen(
                self._command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=self._environment,
            )
        asked, answered = self._process.stdin, self._process.stdout
        assert asked is not None
        assert answered is not None
        try:
            asked.write(os.fsencode(f"{line}\n"))
            asked.flush()
        except BrokenPipeError:
            self._end()
            return {"error": "the program died"}
        ready, _, _ = select.select([answered], [], [], MOST_SECONDS)
        answer = answered.readline() if ready else b""
        if answer:
            found: dict[str, Any] = json.loads(answer)
            return found
        self._end()
        return {"error": "the program died" if ready else f"no answer in {MOST_SECONDS} s"}

    def _end(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None
