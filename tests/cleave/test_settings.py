"""The settings: read from the environment and validated."""

from pathlib import Path

import pytest

from cleave.settings import InvalidSettings, load_settings, unknown_variables


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


def test_variables_that_are_no_settings_are_found_with_the_nearest_one() -> None:
    environment = {
        "CLEAVE_MAX_FACE": "1",
        "cleave_data_dri": "/data",
        "CLEAVE_COLOUR": "red",
        "CLEAVE_MAX_FACES": "2",
        "CLEAVE_API_KEY": "key",
        "PATH": "/bin",
    }
    assert unknown_variables(environment) == {
        "CLEAVE_COLOUR": None,
        "CLEAVE_MAX_FACE": "CLEAVE_MAX_FACES",
        "cleave_data_dri": "CLEAVE_DATA_DIR",
    }


def test_variables_that_kubernetes_sets_for_its_services_are_no_misspelt_settings() -> None:
    names = ("SERVICE_HOST", "SERVICE_PORT", "SERVICE_PORT_HTTP", "PORT", "PORT_8000_TCP", "PORT_8000_TCP_ADDR")
    environment = dict.fromkeys([f"CLEAVE_{name}" for name in names] + ["CLEAVE_REDIS_PORT_6379_TCP_PROTO"], "")
    assert unknown_variables(environment) == {}


@pytest.mark.parametrize("text", ["https://a.example/, HTTPS://B.example", "https://a.example ,https://b.example//,"])
def test_origins_are_compared_as_browsers_send_them(text: str) -> None:
    assert load_settings(cors_origins=text).allowed_origins() == ["https://a.example", "https://b.example"]
