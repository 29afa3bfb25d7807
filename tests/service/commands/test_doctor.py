"""`cleave doctor`: the findings as text, as JSON and as the exit status."""

import json
from pathlib import Path

import pytest

from helpers.queue_servers import StartServer
from service.commands.main import main
from worker.jobs.store.opening import open_folder


def test_findings_are_text_or_json_and_errors_set_the_exit_status(
    start_server: StartServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CLEAVE_REDIS_URL", start_server())
    assert main(["doctor", "--data-dir", str(tmp_path)]) == 1
    text = capsys.readouterr().out
    assert "error    workers: none for small jobs is alive.\n         -> Start one: cleave worker --queue small" in text
    assert main(["doctor", "--data-dir", str(tmp_path), "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert document["healthy"] is False
    assert {finding["severity"] for finding in document["findings"]} == {"ok", "warning", "error"}


def test_a_missing_queue_server_is_a_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("CLEAVE_REDIS_URL", raising=False)
    assert main(["doctor", "--data-dir", str(tmp_path / "data")]) == 0
    assert "Start `cleave serve`" in capsys.readouterr().out


def test_the_doctor_makes_nothing_and_leaves_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("CLEAVE_REDIS_URL", raising=False)
    folder = tmp_path / "data"
    main(["doctor", "--data-dir", str(folder)])
    assert "does not exist yet, and the first start can make it" in capsys.readouterr().out
    assert not folder.exists()
    open_folder(folder)
    folder.chmod(0o700)
    before = sorted(folder.rglob("*"))
    main(["doctor", "--data-dir", str(folder)])
    assert sorted(folder.rglob("*")) == before
