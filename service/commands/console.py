"""Output on a terminal: lines of text, a progress bar, and a board of progress bars."""

import os
import sys
import threading
import time
from types import TracebackType
from typing import TextIO

_MINUTES_FROM_S = 100  # from which minutes are shown, as the page does; set by hand
_BAR_WIDTH, _BOARD_BAR_WIDTH = 30, 20  # characters; with its percentage and stage, either fits on a line of 80
# Control characters, and bytes of file names that are no text, which Python has as U+DC80 to U+DCFF.
_ESCAPES = {
    **{code: f"\\x{code:02x}" for code in (*range(32), *range(127, 160)) if chr(code) not in "\n\t"},
    **{0xDC00 + byte: f"\\x{byte:02x}" for byte in range(128, 256)},
}
_NAME_WIDTH = 24  # of a name on the board; longer names are cut


def printable(text: str) -> str:
    """Return text without control characters: the name of a file must not command the terminal."""
    return text.translate(_ESCAPES)


def say(text: str) -> None:
    """Print text at once. If the standard output is a pipe that has been closed, as ``head`` does, print nothing."""
    try:
        print(printable(text), flush=True)
    except BrokenPipeError:  # the work goes on
        forget_output()


def forget_output() -> None:
    """Write nothing more to the standard output; otherwise the interpreter would complain about the rest at its end."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def say_beside(text: str) -> None:
    """Print text on the standard error."""
    print(printable(text), file=sys.stderr, flush=True)


class ProgressBar:
    """Draws the progress of one task as an ``on_progress`` callback.

    It writes nothing if the output is not a terminal. Leaving its context clears the line.
    """

    def __init__(self, terminal: TextIO) -> None:
        self._terminal = terminal if terminal.isatty() else None
        self._shown = ""
        self._began_at = time.monotonic()

    def __enter__(self) -> "ProgressBar":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._show("")

    def __call__(self, stage: str, fraction: float) -> None:
        from segcore.progress import seconds_left  # here, so that commands without a bar start sooner

        left = _left(seconds_left(time.monotonic() - self._began_at, fraction))
        self._show(f"{_bar(fraction, _BAR_WIDTH)}  {stage}{left}")

    def _show(self, text: str) -> None:
        if self._terminal is None or text == self._shown:
            return
        self._terminal.write("\r" + text.ljust(len(self._shown)) + ("" if text else "\r"))
        self._terminal.flush()
        self._shown = text


class ProgressBoard:
    """Draws a progress bar for each running task, and a line for each task that has ended.

    It writes only the lines if the output is not a terminal. Leaving its context clears the bars. Threads may share it.
    """

    def __init__(self, output: TextIO) -> None:
        self._output = output
        self._is_terminal = output.isatty()
        self._bars: dict[str, tuple[str, float, int | None]] = {}
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

    def show(self, name: str, stage: str, fraction: float, left_s: int | None = None) -> None:
        """Draw the bar of a task; ``left_s`` is an estimate of the seconds until its end."""
        with self._lock:
            self._bars[name] = (stage, fraction, left_s)
            self._draw()

    def finish(self, name: str, sentence: str) -> None:
        """Replace the bar of a task by a line."""
        with self._lock:
            self._bars.pop(name, None)
            self._draw(f"{name}: {sentence}\n")

    def _draw(self, line: str = "") -> None:
        if not self._is_terminal:
            self._output.write(line)
            self._output.flush()
            return
        # Move the cursor up to the first bar and clear everything below it, then write the line and the bars again.
        up = f"\x1b[{self._drawn}F" if self._drawn else ""
        bars = "".join(
            f"{name[:_NAME_WIDTH]:{_NAME_WIDTH}} {_bar(fraction, _BOARD_BAR_WIDTH)} {stage}{_left(left_s)}\n"
            for name, (stage, fraction, left_s) in self._bars.items()
        )
        self._output.write(f"{up}\x1b[J{line}{bars}")
        self._output.flush()
        self._drawn = len(self._bars)


def _left(seconds: int | None) -> str:
    """Return how long a task still takes, in words that follow its stage; empty if that is not known."""
    if seconds is None:
        return ""
    return f", {seconds} s left" if seconds < _MINUTES_FROM_S else f", {round(seconds / 60)} min left"


def _bar(fraction: float, width: int) -> str:
    done = round(width * fraction)
    return f"[{'#' * done}{'.' * (width - done)}] {fraction:4.0%}"
