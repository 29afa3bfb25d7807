"""`cleave doctor`: the findings as text, as JSON and as the exit status."""

import json
from pathlib import Path

import pytest

from helpers.queue_servers import StartServer
from service.commands.main import main


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
