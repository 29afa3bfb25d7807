"""API keys in the settings and in a file."""

from pathlib import Path

import pytest

from cleave.settings import InvalidSettings, Settings
from service.keys import key_digest, key_ring, new_key, parse_keys

ANNA, BORIS = new_key(), new_key()


def test_a_file_of_keys_is_read_again_when_it_changes(tmp_path: Path) -> None:
    file = tmp_path / "keys"
    file.write_text(f"# people\n\nanna {key_digest(ANNA)}\n")
    ring = key_ring(Settings(api_keys_file=file, api_keys=f"boris:{key_digest(BORIS)}"))
    assert (ring.owner_of(ANNA), ring.owner_of(BORIS), ring.owner_of("other")) == ("anna", "boris", None)
    file.write_text("")
    assert (ring.owner_of(ANNA), ring.owner_of(BORIS)) == (None, "boris")


@pytest.mark.parametrize("entry", ["anna", "anna:secret", "Anna:" + "0" * 64, "../x:" + "0" * 64, "_:" + "0" * 64])
def test_an_invalid_entry_is_refused_without_being_shown(entry: str) -> None:
    with pytest.raises(InvalidSettings, match="Entry 1 of HERE") as refused:
        parse_keys([entry], "HERE")
    assert entry not in str(refused.value)
