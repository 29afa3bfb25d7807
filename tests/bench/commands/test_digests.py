"""The digests command: it records, and it compares."""

import json
from pathlib import Path

import pytest

from bench.__main__ import main


@pytest.fixture
def recorded(strips: Path, assets: Path, tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    """The digests of two models of each data set."""
    request.getfixturevalue("one_process")
    output = tmp_path / "a.json"
    options = ["--data", str(strips), "--assets", str(assets), "--limit", "2", "--part", "models"]
    assert main(["digests", *options, "--output", str(output)]) == 0
    return output


def test_equal_files_have_exit_status_0(recorded: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert json.loads(recorded.read_text()).keys() == {"psb/1", "psb/3", "assets/props/crate", "assets/robots/bell"}
    capsys.readouterr()
    assert main(["digests", "--compare", str(recorded), str(recorded)]) == 0
    assert capsys.readouterr().out == "4 equal, 0 different, 0 only in A, 0 only in B.\n"


def test_a_difference_has_exit_status_2_and_a_line(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = json.loads(recorded.read_text())
    document["psb/3"]["7"] = "another"
    del document["psb/1"]
    (tmp_path / "b.json").write_text(json.dumps(document))
    assert main(["digests", "--compare", str(recorded), str(tmp_path / "b.json")]) == 2
    printed = capsys.readouterr()
    assert "psb/3: 7\n2 equal, 1 different, 1 only in A, 0 only in B.\n" in printed.out
    assert "1 results differ" in printed.err


def test_the_choices_are_recorded_for_the_given_models(strips: Path, assets: Path, tmp_path: Path) -> None:
    output = tmp_path / "choices.json"
    options = ["--data", str(strips), "--assets", str(assets), "--part", "choices", "--models", "21"]
    assert main(["digests", *options, "--output", str(output)]) == 0
    document = json.loads(output.read_text())
    assert {key.partition(" ")[0] for key in document} == {"psb/21", "assets/props/crate"}
    assert document['psb/21 {"affinity": "learned"}'] == document['psb/21 {"order": "learned"}']


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "or --compare with two files"),
        (["--data", "{data}", "--assets", "{assets}"], "Give --data, --assets and --output"),
        (["--data", "{data}", "--assets", "{data}", "--output", "{data}/a.json"], "is not the folder of the assets"),
        (["--data", "{data}", "--assets", "{assets}", "--output", "{data}/no/a.json"], "create it first"),
        (["--data", "{data}", "--assets", "{assets}", "--output", "{data}/a.json", "--jobs", "0"], "at least 1"),
        (["--compare", "{data}/none.json", "{data}/none.json"], "cannot be read"),
    ],
)
def test_an_error_is_one_sentence(
    strips: Path, assets: Path, options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["digests", *(option.format(data=strips, assets=assets) for option in options)]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_files_without_a_common_key_are_an_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.json").write_text(json.dumps({name: {"2": "x"}}))
    assert main(["digests", "--compare", str(tmp_path / "a.json"), str(tmp_path / "b.json")]) == 2
    assert "no key in common" in capsys.readouterr().err
