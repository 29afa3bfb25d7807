"""API keys and the names of their owners. Only the digests of keys are stored."""

import hashlib
import hmac
import re
import secrets
from dataclasses import dataclass, field
from pathlib import Path

from cleave.settings import InvalidSettings, Settings

_PREFIX = "cleave_"
_NAME = re.compile(r"[a-z0-9][a-z0-9-]{0,31}", re.ASCII)
_ENTRY = re.compile(rf"({_NAME.pattern})[:\s]+([0-9a-f]{{64}})", re.ASCII)


@dataclass(slots=True)
class KeyRing:
    """The API keys of the settings and of the key file, which may change while the service runs."""

    fixed: dict[str, str]  # name -> SHA-256 of the key, in hexadecimal
    file: Path | None = None
    _from_file: dict[str, str] = field(default_factory=dict, init=False)
    _read_at_ns: int = field(default=-1, init=False)

    def owner_of(self, key: str) -> str | None:
        """Return the name of the owner of a key, None if it is unknown; the run time does not depend on the key."""
        digest = key_digest(key)
        found = None
        for name, known in self.all().items():
            if hmac.compare_digest(digest, known):
                found = name
        return found

    def all(self) -> dict[str, str]:
        """Return the digests of all keys by name; the file is read again if it has changed."""
        if self.file is not None:
            changed_at_ns = self.file.stat().st_mtime_ns
            if changed_at_ns != self._read_at_ns:
                self._from_file = parse_keys(self.file.read_text("utf-8").splitlines(), str(self.file))
                self._read_at_ns = changed_at_ns
        return self.fixed | self._from_file


def key_ring(settings: Settings) -> KeyRing:
    """Return the keys of the settings.

    Raises
    ------
    InvalidSettings
        If an entry is not a name and a digest, or the file cannot be read.
    """
    ring = KeyRing(parse_keys((settings.api_keys or "").split(","), "CLEAVE_API_KEYS"), settings.api_keys_file)
    try:
        ring.all()
    except OSError as error:
        raise InvalidSettings(f"CLEAVE_API_KEYS_FILE cannot be read: {error.strerror}.") from error
    return ring


def is_owner_name(text: str) -> bool:
    """Return whether a text can be the name of the owner of a key."""
    return _NAME.fullmatch(text) is not None


def new_key() -> str:
    """Return a new random key."""
    return _PREFIX + secrets.token_urlsafe(32)


def key_digest(key: str) -> str:
    """Return the SHA-256 of a key. A key has 256 random bits, so that one round of hashing is sufficient."""
    return hashlib.sha256(key.encode("utf-8", "surrogatepass")).hexdigest()


def parse_keys(entries: list[str], source: str) -> dict[str, str]:
    """Return digests by name from entries such as ``anna:9f86d0...``; empty entries and comments are skipped.

    Raises
    ------
    InvalidSettings
        If an entry is not a name and a digest.
    """
    wanted = [entry.strip() for entry in entries if entry.strip() and not entry.strip().startswith("#")]
    matches = [_ENTRY.fullmatch(entry) for entry in wanted]
    if None in matches:
        raise InvalidSettings(
            f"Entry {matches.index(None) + 1} of {source} is not NAME:DIGEST: make one with `cleave key NAME`."
        )
    return {match[1]: match[2] for match in matches if match}
