"""The command `cleave`: help, version, and expected errors in one line with exit status 2."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from cleave.settings import Settings
from service.commands.main import COMMANDS, main


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["segment", "MESH", "--preset", "nobody1999"], "preset must be one of chahhou2014, not 'nobody1999'."),
        (["segment", "MESH", "--set", "solver=luck"], "solver must be one of flow, fiedler"),
        (["segment", "MESH", "--set", "solver"], "a parameter is NAME=VALUE, not 'solver'"),
        (["segment", "MESH", "--set", "colour=red"], "There is no parameter 'colour'"),
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
        (["serve", "--data-dir"], "argument --data-dir: expected one argument"),
        (["worker"], "CLEAVE_REDIS_URL"),
        (["worker", "--redis-url", "http://localhost"], "CLEAVE_REDIS_URL is 'http://localhost'"),
        (["key", "Anna"], "The name of a key must have 1 to 32 characters"),
        (["list"], "invalid choice: 'list'"),
        ([], "the following arguments are required: COMMAND"),
    ],
)
def test_an_expected_error_is_one_line_and_status_2(
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


def test_an_invalid_setting_is_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("CLEAVE_MAX_FACES", "many")
    assert main(["serve"]) == 2
    assert "CLEAVE_MAX_FACES is 'many'" in capsys.readouterr().err


def test_help_and_version_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments, expected in (
        (["--help"], "cleave serve"),
        (["--version"], "cleave "),
        (["serve", "--help"], "CLEAVE_JOB_TIMEOUT_S"),
        (["segment", "--help"], "--segments K"),
    ):
        with pytest.raises(SystemExit, match=r"0|None"):
            main(arguments)
        assert expected in capsys.readouterr().out


def test_every_command_is_in_the_help_and_has_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in ([], *([name] for name in COMMANDS)):
        with pytest.raises(SystemExit, match="0"):
            main([*arguments, "--help"])
        text = capsys.readouterr().out
        assert text.startswith(" ".join(["usage: cleave", *arguments]))
        assert arguments or all(re.search(rf"^    {name}\s", text, re.MULTILINE) for name in COMMANDS)


def test_only_the_given_command_is_imported() -> None:
    script = "import sys; from service.commands.main import main\ntry: main({})\nexcept SystemExit: print(*sys.modules)"
    loaded = {
        name: subprocess.run([sys.executable, "-c", script.format(arguments)], capture_output=True, text=True).stdout
        for name, arguments in {"help": ["--help"], "key": ["key", "--help"], "segment": ["segment", "--help"]}.items()
    }
    modules = {name: set(text.splitlines()[-1].split()) for name, text in loaded.items()}
    heavy = {"numpy", "numba", "redis", "httpx", "fastapi"}
    assert not (heavy | {"pydantic"}) & modules["help"]
    assert not heavy & modules["key"]
    assert {"numpy", "service.commands.segment"} <= modules["segment"]
    assert "service.commands.serve" not in modules["segment"]


@pytest.mark.parametrize("module", ["service.host.http_server", "service.commands.serve", "worker.janitor.janitor"])
def test_a_process_that_computes_nothing_starts_without_kernels(module: str) -> None:
    script = f"import sys, {module}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert {"numba", "scipy", "segcore.method"}.isdisjoint(done.stdout.split())


def test_the_kernel_cache_is_in_the_data_folder_that_is_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folders: list[Path] = []
    monkeypatch.setattr("service.commands.main.prepare_kernel_cache", lambda data_dir: folders.append(data_dir()))
    monkeypatch.setenv("CLEAVE_DATA_DIR", str(tmp_path / "default"))
    for options in ([], ["--data-dir", str(tmp_path / "given")], [f"--data-dir={tmp_path / 'given'}"]):
        with pytest.raises(SystemExit):
            main(["serve", *options, "--help"])
    assert folders == [tmp_path / "default", tmp_path / "given", tmp_path / "given"]


@pytest.mark.parametrize("command", ["serve", "worker"])
def test_the_help_has_every_setting_with_its_default(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main([command, "--help"])
    text = capsys.readouterr().out
    for name in Settings.model_fields:
        assert re.search(rf"^  CLEAVE_{name.upper()} +\S.* Default: \S.*\.$", text, re.MULTILINE), name
    assert "Default: 8589934592." in text
