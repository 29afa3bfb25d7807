"""`cleave convert` and `cleave inspect`: files that cannot be used are one line and exit status 2."""

from pathlib import Path

import pytest

import segcore
from service.commands.main import main


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["convert", "ball.off", "-o", "a.ply"], "This is not a .cleave file"),
        (["convert", "none.cleave", "-o", "a.ply"], "none.cleave: No such file or directory."),
        (["convert", "ball.cleave", "-o", "a.ply", "--segments", "9999"], "from 1 to"),
        (["convert", "ball.cleave", "-o", "a.dae"], "'a.dae' must end in one of .glb"),
        (["convert", "ball.cleave", "-o", "no/a.ply"], "no: There is no such folder."),
        (["convert", "ball.cleave"], "-o/--output"),
        (["convert", "ball.cleave", "-o", "a.glb", "--keep", "all"], "name its file with --source"),
        (["convert", "ball.cleave", "-o", "a.glb", "--keep", "all", "--source", "square.off"], "not the file that was"),
        (["inspect", "none.off"], "none.off: No such file or directory."),
        (["inspect", "ball.cleave"], "cleave convert"),
    ],
)
def test_an_expected_error_is_one_line_and_status_2(
    ball: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    sentence: str,
) -> None:
    monkeypatch.chdir(ball)
    (ball / "square.off").write_bytes(b"OFF 4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")
    try:
        status = main(arguments)
    except SystemExit as exit_of_the_parser:
        status = int(str(exit_of_the_parser.code))
    output, errors = capsys.readouterr()
    assert (status, output, errors.count("\n")) == (2, "", 1)
    assert errors.startswith("cleave: ")
    assert sentence in errors
    assert not (ball / "a.ply").exists()


def test_a_unit_and_an_axis_can_be_said_and_wanted(ball: Path, tmp_path: Path) -> None:
    said = ["--unit", "in", "--up", "y"]
    outputs = ["-o", str(tmp_path / "ball.3mf"), "-o", str(tmp_path / "ball.obj"), "--output-unit", "cm"]
    assert main(["convert", str(ball / "ball.cleave"), *said, *outputs]) == 0
    inches = segcore.read_mesh(ball / "ball.off").bounds[1]
    assert segcore.read_mesh(tmp_path / "ball.3mf").bounds[1] == pytest.approx(25.4 * inches[[0, 2, 1]], rel=1e-6)
    assert segcore.read_mesh(tmp_path / "ball.obj").bounds[1] == pytest.approx(2.54 * inches, rel=1e-6)
