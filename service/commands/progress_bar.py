"""A progress bar for a person at a terminal."""

from types import TracebackType
from typing import TextIO

_WIDTH = 30


class ProgressBar:
    """An ``on_progress`` that draws on a terminal, and draws nothing elsewhere; as a context it clears up its line."""

    def __init__(self, terminal: TextIO) -> None:
        self._terminal = terminal if terminal.isatty() else None
        self._shown = ""

    def __enter__(self) -> "ProgressBar":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._show("")

    def __call__(self, stage: str, fraction: float) -> None:
        done = round(_WIDTH * fraction)
        self._show(f"[{'#' * done}{'.' * (_WIDTH - done)}] {fraction:4.0%}  {stage}")

    def _show(self, text: str) -> None:
        if self._terminal is None or text == self._shown:
            return
        self._terminal.write("\r" + text.ljust(len(self._shown)) + ("" if text else "\r"))
        self._terminal.flush()
        self._shown = text
