"""Commands in pipes: the mesh from the standard input, one output to the standard output, messages beside it."""

import subprocess
import sys
from pathlib import Path

import pytest

from segcore.io import read_mesh
from service.commands.main import main


def cleave(*arguments: str, data: bytes = b"") -> "subprocess.CompletedProcess[bytes]":
    command = [sys.executable, "-m", "service.commands", *arguments]
    return subprocess.run(command, input=data, capture_output=True, timeout=120, check=False)


def test_a_mesh_goes_through_a_pipe_and_messages_stay_out_of_it(mesh: Path, tmp_path: Path) -> None:
    done = cleave("segment", "-", "--segments", "3", "-o", "-", "--to", "ply", data=mesh.read_bytes())
    assert done.returncode == 0, done.stderr
    (tmp_path / "parts.ply").write_bytes(done.stdout)
    assert len(read_mesh(tmp_path / "parts.ply").faces) == len(read_mesh(mesh).faces)
    assert done.stderr.decode().startswith("standard input: 528 faces, ")
    assert b"3 segments, as requested" in done.stderr


def test_labels_go_to_the_standard_output(mesh: Path) -> None:
    done = cleave("segment", str(mesh), "--segments", "4", "--labels", "-")
    assert sorted({int(line) for line in done.stdout.split()}) == [0, 1, 2, 3]
    assert len(done.stdout.split()) == 528


def test_a_result_is_converted_in_a_pipe(ball: Path) -> None:
    done = cleave("convert", "-", "-o", "-", "--to", "glb", data=(ball / "ball.cleave").read_bytes())
    assert done.returncode == 0, done.stderr
    assert done.stdout[:4] == b"glTF"


def test_a_mesh_is_inspected_in_a_pipe(mesh: Path) -> None:
    assert b"standard input: 528 faces" in cleave("inspect", "-", data=mesh.read_bytes()).stdout


def test_a_reader_that_stops_early_is_no_error(mesh: Path) -> None:
    command = f"{sys.executable} -m service.commands segment {mesh} -o - --to obj | head -c 10; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, timeout=120, check=False)
    assert (done.returncode, len(done.stdout)) == (0, 10)
    assert b"Broken pipe" not in done.stderr


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["-o", "-"], "name its format, such as --to glb"),
        (["-o", "-", "--to", "glb", "--labels", "-"], "Two outputs are the standard output"),
        (["-o", "-", "--to", "dae"], "invalid choice: 'dae'"),
    ],
)
def test_outputs_that_cannot_go_there_are_refused_before_the_work(
    mesh: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], sentence: str
) -> None:
    try:
        status = main(["segment", str(mesh), *arguments])
    except SystemExit as exit_of_the_parser:
        status = int(str(exit_of_the_parser.code))
    assert status == 2
    assert sentence in capsys.readouterr().err


def test_everything_can_be_kept_only_of_a_file(mesh: Path) -> None:
    done = cleave("segment", "-", "-o", "-", "--to", "glb", "--keep", "all", data=mesh.read_bytes())
    assert done.returncode == 2
    assert b"To keep everything of the input, name its file" in done.stderr
