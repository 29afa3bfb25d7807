"""`cleave key`: a key and its entry for the settings."""

import pytest

from cleave.settings import Settings
from service.commands.main import main
from service.keys import key_ring


def test_a_key_is_accepted_with_its_entry_in_the_settings(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["key", "anna-2"]) == 0
    key, entry = (line.split()[1] for line in capsys.readouterr().out.splitlines()[:2])
    assert key not in entry
    assert key_ring(Settings(api_keys=entry)).owner_of(key) == "anna-2"
