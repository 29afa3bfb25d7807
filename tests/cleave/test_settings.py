"""The settings: read from the environment and validated."""

from pathlib import Path

import pytest

from cleave.settings import InvalidSettings, load_settings


def test_the_environment_overrides_the_defaults(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLEAVE_MAX_FACES", "1234")
    monkeypatch.setenv("CLEAVE_REDIS_URL", "")
    settings = load_settings()
    assert settings.max_faces == 1234
    assert settings.redis_url is None


def test_an_argument_overrides_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CLEAVE_DATA_DIR", "/nowhere")
    assert load_settings(data_dir=tmp_path).data_dir == tmp_path
    assert load_settings(data_dir=None).data_dir == Path("/nowhere")


def test_the_data_folder_does_not_depend_on_the_working_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CLEAVE_DATA_DIR", "data")
    assert load_settings().data_dir == tmp_path / "data"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("CLEAVE_MAX_FACES", "many"),
        ("CLEAVE_MAX_ATTEMPTS", "0"),
        ("CLEAVE_LEASE_S", "31"),
        ("CLEAVE_REDIS_URL", "http://localhost"),
        ("CLEAVE_JOB_TIMEOUT_S", "-1"),
    ],
)
def test_an_invalid_value_is_refused_with_the_name_of_its_variable(
    monkeypatch: pytest.MonkeyPatch, name: str, value: str
) -> None:
    monkeypatch.setenv(name, value)
    with pytest.raises(InvalidSettings, match=f"^{name} is '{value}'"):
        load_settings()
