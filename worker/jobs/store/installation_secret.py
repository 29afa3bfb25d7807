"""A secret that an installation makes for itself, from which others are derived."""

import hmac
import secrets

from worker.jobs.objects.interface import ObjectStorage, StoreError

_KEY = "secret"
_BYTES = 32


class InstallationSecret:
    """The same for every process that shares the store; read when it is first needed."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects
        self._secret: bytes | None = None

    def derive(self, *purpose: str) -> bytes:
        """32 bytes that nobody can tell from random ones who does not know the secret."""
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
            raise StoreError("The store does not give back the secret that was put into it.")
        return secret
