"""`cleave segment`: the summary and the outputs are those of the library."""

import errno
import io
import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

import segcore
from helpers.files.samples import TWO_SQUARES
from segcore.io.result import read_result, write_result
from segcore.kernels import FIRST, CompilationProgress
from service.commands.main import main


def test_the_summary_has_the_number_of_faces_and_segments(mesh: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["segment", str(mesh)]) == 0
    output, errors = capsys.readouterr()
    hierarchy = segcore.segment(segcore.read_mesh(mesh))
    assert output.startswith(f"ball.off: {4 * 12 * 11} faces, ")
    end = f"the hierarchy ends at {hierarchy.max_segments}: no sensible cut is left"
    assert f"\n{hierarchy.automatic_segments} segments, chosen automatically; {end}\n" in output
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


def test_the_result_file_has_the_bytes_that_the_library_writes(mesh: Path, tmp_path: Path) -> None:
    assert main(["segment", str(mesh), "--result", str(tmp_path / "ball.cleave")]) == 0
    read = segcore.read_mesh(mesh, appearance=True)
    expected = io.BytesIO()
    write_result(expected, read, segcore.segment(read))
    assert (tmp_path / "ball.cleave").read_bytes() == expected.getvalue()


def test_threads_change_no_byte_and_must_be_at_least_one(
    mesh: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = [tmp_path / f"{count}.cleave" for count in (1, 2)]
    for count, path in enumerate(paths, start=1):
        assert main(["segment", str(mesh), "--threads", str(count), "--result", str(path)]) == 0
    assert paths[0].read_bytes() == paths[1].read_bytes()
    assert main(["segment", str(mesh), "--threads", "0"]) == 2
    assert "The number of threads must be at least 1, not 0." in capsys.readouterr().err


def test_a_granularity_can_be_given_instead_of_a_number(
    mesh: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    expected = segcore.segment(segcore.read_mesh(mesh))
    direct, converted, result = tmp_path / "direct.seg", tmp_path / "converted.seg", tmp_path / "ball.cleave"
    outputs = ["-o", str(direct), "--result", str(result)]
    assert main(["segment", str(mesh), "--granularity", "0.7", *outputs]) == 0
    assert main(["convert", str(result), "--granularity", "0.7", "-o", str(converted)]) == 0
    labels = [str(label) for label in expected.labels(expected.segments_at(0.7)).tolist()]
    assert direct.read_text().split() == converted.read_text().split() == labels
    assert capsys.readouterr().out.count(f"{expected.segments_at(0.7)} segments, as requested") == 2


def test_the_hierarchy_grows_to_the_number_of_segments(mesh: Path, tmp_path: Path) -> None:
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


def test_an_output_that_is_a_pipe_is_not_replaced(mesh: Path, tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    command = [sys.executable, "-m", "service.commands", "segment", str(mesh), "--labels", str(pipe)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL):
        assert len(pipe.read_text().split()) == 4 * 12 * 11
    assert pipe.is_fifo()


def test_the_summary_has_the_structure_of_the_file_and_says_if_it_fills_the_hierarchy(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "two.obj"
    path.write_text(TWO_SQUARES)
    counts = "structure of the file: 2 shells, 2 groups, 1 material"
    assert main(["segment", str(path)]) == 0
    assert capsys.readouterr().out.splitlines()[4:] == [counts]
    labels = tmp_path / "labels.seg"
    for given in (["--structure", "groups"], ["--set", "structure=groups"]):
        assert main(["segment", str(path), "--max-segments", "2", *given, "--labels", str(labels)]) == 0
        lines = capsys.readouterr().out.splitlines()
        assert lines[1].startswith("2 segments, chosen automatically; ")
        assert lines[4] == counts
        assert lines[5].startswith("The hierarchy ends with the 2 groups of the file")
        assert labels.read_text().split() in (["0", "0", "1", "1"], ["1", "1", "0", "0"])


def test_a_file_without_groups_cannot_be_cut_by_them(mesh: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["segment", str(mesh), "--structure", "groups"]) == 2
    assert "This file has no groups: use structure=shells" in capsys.readouterr().err


def test_a_pipe_that_is_closed_early_is_no_error(mesh: Path, tmp_path: Path) -> None:
    output = tmp_path / "parts.glb"
    program = "import sys; from service.commands.main import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", program, "segment", str(mesh), "-o", str(output)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        errors = process.stderr.read()
    assert (process.returncode, errors) == (0, b"")
    assert output.stat().st_size > 0


def test_a_compilation_is_announced_by_a_line_or_shown_on_a_terminal(
    mesh: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def compile_kernels(_: tuple[str, ...], on_progress: Callable[[CompilationProgress], object]) -> None:
        on_progress(CompilationProgress(14, 52))

    monkeypatch.setattr("service.commands.segment.must_compile", lambda _: False)
    assert main(["segment", str(mesh)]) == 0
    assert capsys.readouterr().err == ""
    monkeypatch.setattr("service.commands.segment.must_compile", lambda groups: groups == FIRST)
    monkeypatch.setattr("service.commands.segment.compile_kernels", compile_kernels)
    assert main(["segment", str(mesh)]) == 0
    assert capsys.readouterr().err == "Compiling the kernels, which takes up to half a minute and is done once.\n"
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert main(["segment", str(mesh)]) == 0
    errors = capsys.readouterr().err
    assert "compiling, once: 14 of 52" in errors
    assert "half a minute" not in errors


def test_a_file_that_cannot_be_read_is_reported_while_the_kernels_of_segmentations_are_compiled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    reported, has_readers = threading.Event(), False

    def must_compile(groups: Sequence[str]) -> bool:
        return "segment" in groups or not has_readers

    def compile_kernels(groups: Sequence[str], _: object) -> None:
        nonlocal has_readers
        assert list(groups) == ["read", "segment"]
        has_readers = True
        assert reported.wait(60)

    monkeypatch.setattr("service.commands.segment.must_compile", must_compile)
    monkeypatch.setattr("service.commands.segment.compile_kernels", compile_kernels)
    bad = tmp_path / "bad.off"
    bad.write_text("OFF 3 1 0\n0 0 0\n")
    assert main(["segment", str(bad)]) == 2
    reported.set()
    assert "it is cut short" in capsys.readouterr().err


def test_a_compilation_that_cannot_write_ends_the_command(
    mesh: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def compile_kernels(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("service.commands.segment.must_compile", lambda _: True)
    monkeypatch.setattr("service.commands.segment.compile_kernels", compile_kernels)
    assert main(["segment", str(mesh)]) != 0
    assert "No space left on device" in capsys.readouterr().err
