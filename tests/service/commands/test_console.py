"""Progress bars are drawn on terminals only."""

import io
import os
import pty
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from service.commands.console import ProgressBar, ProgressBoard
from service.commands.main import main


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def read_terminal(reader: int) -> str:
    """Read what is written to a terminal until its last writer closes it."""
    written = b""
    with suppress(OSError):  # on Linux, EIO is the end of the file
        while piece := os.read(reader, 4096):
            written += piece
    os.close(reader)
    return written.decode()


@pytest.mark.slow
def test_a_command_draws_a_progress_bar_on_a_terminal(mesh: Path) -> None:
    reader, terminal = pty.openpty()
    command = [sys.executable, "-m", "service.commands", "segment", str(mesh)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=terminal):
        os.close(terminal)
        shown = read_terminal(reader)
    assert "100%" in shown
    assert shown.endswith("\r")
    assert "\n" not in shown


def test_no_progress_bar_is_written_to_a_file(tmp_path: Path) -> None:
    path = tmp_path / "log"
    with path.open("w") as file, ProgressBar(file) as bar:
        bar("cut", 0.5)
    assert path.read_text() == ""


def test_a_board_shows_a_bar_for_each_running_task_and_a_line_for_each_that_has_ended() -> None:
    terminal, file = Terminal(), io.StringIO()
    for output in (terminal, file):
        with ProgressBoard(output) as board:
            board.show("a.off", "cut", 0.4, left_s=130)
            board.show("a.off", "cut", 0.5, left_s=7)
            board.show("b.off", "queued", 0.0)
            board.finish("a.off", "3 segments")
    assert file.getvalue() == "a.off: 3 segments\n"
    assert "[##########..........]  50% cut, 7 s left\n" in terminal.getvalue()
    assert "[########............]  40% cut, 2 min left\n" in terminal.getvalue()
    last_drawn, cleared = terminal.getvalue().split("\x1b[J")[-2:]
    assert last_drawn.startswith("a.off: 3 segments\nb.off ")
    assert last_drawn.endswith("\x1b[1F")
    assert cleared == ""


def test_names_cannot_command_the_terminal(mesh: Path, capsys: pytest.CaptureFixture[str]) -> None:
    hostile = mesh.with_name(os.fsdecode(b"\x1b[2J\xc2\x9b\xff.off"))
    mesh.rename(hostile)
    assert main(["inspect", str(hostile)]) == 0
    assert capsys.readouterr().out.startswith("\\x1b[2J\\x9b\\xff.off: ")
    assert main(["inspect", f"{hostile}.missing"]) == 2
    assert "\\x1b[2J\\x9b\\xff.off.missing: No such file or directory.\n" in capsys.readouterr().err
