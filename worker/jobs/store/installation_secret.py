"""The secret of an installation, generated once and kept in the store, from which all others are derived."""

import hmac
import secrets

from worker.jobs.objects.interface import ObjectStorage, StoreError

_KEY = "secret"
_BYTES = 32  # the output size of SHA-256


class InstallationSecret:
    """The same secret for every process that uses the store; it is read at the first use."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects
        self._secret: bytes | None = None

    def derive(self, *purpose: str) -> bytes:
        """Return the HMAC-SHA256 of a purpose, 32 bytes, under the secret."""
        if self._secret is None:
            self._secret = self._read()
        text = "\0".join(f"{len(part)}:{part}" for part in purpose)
        return hmac.digest(self._secret, text.encode("utf-8", "surrogatepass"), "sha256")

    def _read(self) -> bytes:
        secret = self._objects.get(_KEY)
        if secret is None:
            self._objects.create(_KEY, secrets.token_bytes(_BYTES))
            secret = self._objects.get(_KEY)
        if secret is None:
            raise StoreError("The store does not return the secret that was written to it.")
        return secret
