"""The checks of this machine: limits, access and unknown settings."""

import resource
from pathlib import Path

import pytest

from cleave.settings import Settings
from helpers.findings import severities
from service.doctor.machine_checks import check_machine

LIMITS = ("open files", "file size", "memory", "memory of a job", "kernels", "settings")


def test_limits_of_the_machine_are_compared_with_the_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    small = {resource.RLIMIT_NOFILE: 256, resource.RLIMIT_FSIZE: 1000}
    monkeypatch.setattr(resource, "getrlimit", lambda which: (small[which], small[which]))
    monkeypatch.setattr("service.doctor.machine_checks.memory_bytes", lambda: 2**30)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("CLEAVE_MAX_FACE", "7")
    found = {finding.topic: finding for finding in check_machine(Settings(data_dir=tmp_path), "127.0.0.1")}
    assert {topic: found[topic].severity for topic in LIMITS} == {
        "open files": "warning",
        "file size": "error",
        "memory": "warning",
        "memory of a job": "warning",
        "kernels": "warning",
        "settings": "warning",
    }
    assert "CLEAVE_MAX_FACES to 1373634" in str(found["memory"].fix)
    assert "CLEAVE_MAX_FACE is not a setting" in found["settings"].message


@pytest.mark.parametrize(
    ("auth", "host", "severity"),
    [
        ("auto", "127.0.0.1", "ok"),
        ("auto", "0.0.0.0", "error"),
        ("off", "0.0.0.0", "warning"),
        ("required", "::1", "error"),
    ],
)
def test_access_to_the_service_is_checked(tmp_path: Path, auth: str, host: str, severity: str) -> None:
    settings = Settings.model_validate({"data_dir": tmp_path, "auth": auth})
    assert severities(check_machine(settings, host))["access"] == severity


def test_extras_that_are_missing_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.doctor.machine_checks.missing_extras", lambda: ["mcp", "print"])
    found = {finding.topic: finding for finding in check_machine(Settings(data_dir=tmp_path), "127.0.0.1")}
    assert found["extras"].severity == "ok"
    assert found["extras"].message == "not installed: mcp, print; to add them: pip install 'cleave-mesh[mcp,print]'."
