"""A secret that an installation makes for itself, from which others are derived."""

import hmac
import secrets
from pathlib import Path

from worker.durable import create_file

_BYTES = 32


class InstallationSecret:
    """The same for every process that shares the data folder."""

    def __init__(self, data_dir: Path) -> None:
        path = data_dir / "secret"
        if not path.exists():
            create_file(path, secrets.token_bytes(_BYTES))
        self._secret = path.read_bytes()

    def derive(self, *purpose: str) -> bytes:
        """32 bytes that nobody can tell from random ones who does not know the secret."""
        text = "\0".join(f"{len(part)}:{part}" for part in purpose)
        return hmac.digest(self._secret, text.encode("utf-8", "surrogatepass"), "sha256")
