"""The command `cleave`: what it prints, what it writes, and one line with exit status 2 where it cannot."""

import json
import os
import pty
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

import segcore
from helpers.jobs import sphere
from segcore.io.result import read_result
from service.commands.main import main
from service.commands.progress_bar import ProgressBar


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    path = tmp_path / "ball.off"
    path.write_bytes(sphere(12))
    return path


def test_a_summary_says_what_came_out(mesh: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["segment", str(mesh)]) == 0
    output, errors = capsys.readouterr()
    automatic = segcore.segment(segcore.read_mesh(mesh)).automatic_segments
    assert output.startswith(f"ball.off: {4 * 12 * 11} faces, ")
    assert f"\n{automatic} segments, chosen automatically; 1 to " in output
    assert errors == ""


def test_every_output_is_of_the_same_segmentation(mesh: Path, tmp_path: Path) -> None:
    paths = {name: tmp_path / name for name in ("parts.glb", "labels.seg", "tree.json", "ball.cleave")}
    outputs = ["-o", paths["parts.glb"], "--labels", paths["labels.seg"], "--hierarchy", paths["tree.json"]]
    arguments = ["segment", mesh, "--segments", 5, *outputs, "--result", paths["ball.cleave"]]
    assert main([str(argument) for argument in arguments]) == 0
    expected = segcore.segment(segcore.read_mesh(mesh)).labels(5).tolist()
    assert [int(line) for line in paths["labels.seg"].read_text().split()] == expected
    assert read_result(paths["ball.cleave"]).hierarchy.labels(5).tolist() == expected
    assert b"segment 4" in paths["parts.glb"].read_bytes()
    assert len(json.loads(paths["tree.json"].read_text())["nodes"]) > 5


def test_a_granularity_stands_in_place_of_a_number(
    mesh: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    expected = segcore.segment(segcore.read_mesh(mesh))
    direct, converted, result = tmp_path / "direct.seg", tmp_path / "converted.seg", tmp_path / "ball.cleave"
    outputs = ["-o", str(direct), "--result", str(result)]
    assert main(["segment", str(mesh), "--granularity", "0.7", *outputs]) == 0
    assert main(["convert", str(result), "--granularity", "0.7", "-o", str(converted)]) == 0
    labels = [str(label) for label in expected.labels(expected.segments_at(0.7)).tolist()]
    assert direct.read_text().split() == converted.read_text().split() == labels
    assert capsys.readouterr().out.count(f"{expected.segments_at(0.7)} segments, as asked") == 2


def test_more_segments_than_the_default_hierarchy_has_can_be_asked_for(mesh: Path, tmp_path: Path) -> None:
    labels = tmp_path / "labels.seg"
    assert main(["segment", str(mesh), "--segments", "100", "--labels", str(labels)]) == 0
    assert len(set(labels.read_text().split())) == 100


def test_a_preset_and_parameters_change_the_method(mesh: Path, tmp_path: Path) -> None:
    labels = tmp_path / "labels.seg"
    chosen = ["--preset", "chahhou2014", "--set", "solver=fiedler", "--set", "max_segments=8"]
    assert main(["segment", str(mesh), "--segments", "4", *chosen, "--labels", str(labels)]) == 0
    parameters = {"preset": "chahhou2014", "solver": "fiedler", "max_segments": 8}
    expected = segcore.segment(segcore.read_mesh(mesh), segcore.SegmentationParameters.from_mapping(parameters))
    assert [int(line) for line in labels.read_text().split()] == expected.labels(4).tolist()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["segment", "MESH", "--preset", "nobody1999"], "preset must be one of chahhou2014, not 'nobody1999'."),
        (["segment", "MESH", "--set", "solver=luck"], "solver must be one of flow, fiedler"),
        (["segment", "MESH", "--set", "solver"], "a parameter is NAME=VALUE, not 'solver'"),
        (["segment", "MESH", "--set", "colour=red"], "Unknown parameter 'colour'"),
        (["segment", "nowhere.off"], "nowhere.off: No such file or directory."),
        (["segment", "MESH", "--segments", "0"], "The number of segments must be at least 1, not 0."),
        (["segment", "MESH", "--granularity", "2"], "a granularity is a number from 0 (coarse) to 1 (fine), not '2'"),
        (["segment", "MESH", "--granularity", "nan"], "not 'nan'"),
        (["segment", "MESH", "--segments", "3", "--granularity", "1"], "not allowed with argument --segments"),
        (["segment", "MESH", "--segments", "9999"], "The number of segments must be from 1 to"),
        (["segment", "MESH", "--max-segments", "0"], "max_segments must be an integer"),
        (["segment", "MESH", "--labels", "no/such/folder"], "no/such: There is no such folder."),
        (["segment", "MESH", "-o", "parts.dae"], "must end in one of .glb .ply"),
        (["segment", "EMPTY"], "."),
        (["segment"], "the following arguments are required: MESH"),
        (["serve", "--port", "70000"], "a port is a number from 0 to 65535"),
        (["serve", "--workers", "-1"], "must be at least 0"),
        (["serve", "--host", "no.such.host.invalid"], "Cannot listen on no.such.host.invalid port 8000: "),
        (["worker"], "CLEAVE_REDIS_URL"),
        (["worker", "--redis-url", "http://localhost"], "CLEAVE_REDIS_URL is 'http://localhost'"),
        ([], "the following arguments are required: COMMAND"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_status_2(
    mesh: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    sentence: str,
) -> None:
    (tmp_path / "empty.off").touch()
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CLEAVE_REDIS_URL", raising=False)
    monkeypatch.setenv("CLEAVE_DATA_DIR", str(tmp_path / "data"))
    names = {"MESH": str(mesh), "EMPTY": "empty.off"}
    try:
        status = main([names.get(argument, argument) for argument in arguments])
    except SystemExit as exit_of_the_parser:
        status = int(str(exit_of_the_parser.code))
    output, errors = capsys.readouterr()
    assert status == 2
    assert errors.startswith("cleave: ")
    assert sentence in errors
    assert errors.count("\n") == 1
    assert output == ""


def test_a_setting_that_cannot_be_used_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CLEAVE_MAX_FACES", "many")
    assert main(["serve"]) == 2
    assert "CLEAVE_MAX_FACES is 'many'" in capsys.readouterr().err


def test_an_output_that_is_no_file_is_not_replaced(mesh: Path, tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    command = [sys.executable, "-m", "service.commands", "segment", str(mesh), "--labels", str(pipe)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL):
        assert len(pipe.read_text().split()) == 4 * 12 * 11
    assert pipe.is_fifo()


def test_help_and_version_are_for_people(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments, expected in (
        (["--help"], "cleave serve"),
        (["--version"], "cleave "),
        (["serve", "--help"], "CLEAVE_JOB_TIMEOUT_S"),
        (["segment", "--help"], "--segments K"),
    ):
        with pytest.raises(SystemExit, match=r"0|None"):
            main(arguments)
        assert expected in capsys.readouterr().out


def test_a_person_at_a_terminal_sees_a_progress_bar(mesh: Path) -> None:
    reader, terminal = pty.openpty()
    command = [sys.executable, "-m", "service.commands", "segment", str(mesh)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=terminal):
        os.close(terminal)
        shown = read_terminal(reader)
    assert "100%" in shown
    assert shown.endswith("\r")
    assert "\n" not in shown


def read_terminal(reader: int) -> str:
    """Everything that is written to a terminal until its last writer closes it."""
    written = b""
    with suppress(OSError):  # EIO is how Linux tells the end
        while piece := os.read(reader, 4096):
            written += piece
    os.close(reader)
    return written.decode()


def test_a_file_sees_no_progress_bar(tmp_path: Path) -> None:
    path = tmp_path / "log"
    with path.open("w") as file, ProgressBar(file) as bar:
        bar("cut", 0.5)
    assert path.read_text() == ""
