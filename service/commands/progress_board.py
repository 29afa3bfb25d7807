"""Progress bars for several things at once, for a person at a terminal; elsewhere a line for each that has ended."""

import threading
from types import TracebackType
from typing import TextIO

_WIDTH = 20
_NAME = 24  # characters


class ProgressBoard:
    """A bar for everything that is being done; as a context it clears up after itself. Threads may share it."""

    def __init__(self, output: TextIO) -> None:
        self._output = output
        self._is_terminal = output.isatty()
        self._bars: dict[str, tuple[str, float]] = {}
        self._drawn = 0
        self._lock = threading.Lock()

    def __enter__(self) -> "ProgressBoard":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._lock:
            self._bars.clear()
            self._draw()

    def show(self, name: str, stage: str, fraction: float) -> None:
        with self._lock:
            self._bars[name] = (stage, fraction)
            self._draw()

    def finish(self, name: str, sentence: str) -> None:
        with self._lock:
            self._bars.pop(name, None)
            self._draw(f"{name}: {sentence}\n")

    def _draw(self, line: str = "") -> None:
        if not self._is_terminal:
            self._output.write(line)
            self._output.flush()
            return
        # Up to the first bar, everything below it away, then the line and the bars again.
        up = f"\x1b[{self._drawn}F" if self._drawn else ""
        bars = "".join(_bar(name, *state) for name, state in self._bars.items())
        self._output.write(f"{up}\x1b[J{line}{bars}")
        self._output.flush()
        self._drawn = len(self._bars)


def _bar(name: str, stage: str, fraction: float) -> str:
    done = round(_WIDTH * fraction)
    return f"{name[:_NAME]:{_NAME}} [{'#' * done}{'.' * (_WIDTH - done)}] {fraction:4.0%} {stage}\n"
