"""Upload quotas: the bytes that each owner has uploaded in the current hour, counted in Redis."""

import time
from dataclasses import dataclass

from redis import Redis

WINDOW_S = 3600  # of the setting key_upload_bytes_per_hour


@dataclass(frozen=True, slots=True)
class Uploaded:
    size_bytes: int
    ends_in_s: int  # until the count starts again


class UploadQuota:
    """The uploaded bytes of all owners; if Redis loses its data, they count from 0 again."""

    def __init__(self, connection: Redis) -> None:
        self._connection = connection

    def uploaded(self, owner: str | None) -> Uploaded:
        key, ends_in_s = _window(owner)
        return Uploaded(int(self._connection.get(key) or 0), ends_in_s)

    def add(self, owner: str | None, size_bytes: int) -> None:
        key, _ = _window(owner)
        with self._connection.pipeline() as transaction:
            transaction.incrby(key, size_bytes)
            transaction.expire(key, WINDOW_S)
            transaction.execute()


def _window(owner: str | None) -> tuple[str, int]:
    at_s = int(time.time())
    return f"cleave:uploaded:{owner or ''}:{at_s // WINDOW_S}", WINDOW_S - at_s % WINDOW_S
