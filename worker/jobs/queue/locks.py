"""Locks in Redis for work that one process of an installation does at a time."""

from redis import Redis

from worker.jobs.queue.connection import milliseconds

_LEADER_KEY = "cleave:janitor"


class Locks:
    """Locks that expire if the process that holds them dies."""

    def __init__(self, connection: Redis) -> None:
        self._connection = connection

    def acquire(self, name: str, holder: str, ttl_s: float) -> bool:
        """Acquire a lock for a time; False if it is held, also by the same holder."""
        return bool(self._connection.set(_key(name), holder, nx=True, px=milliseconds(ttl_s)))

    def release(self, name: str) -> None:
        self._connection.delete(_key(name))

    def lead(self, holder: str, ttl_s: float) -> bool:
        """Become or stay the leading janitor for a time; False if another one leads."""
        with self._connection.pipeline() as transaction:
            transaction.set(_LEADER_KEY, holder, nx=True, px=milliseconds(ttl_s))
            transaction.get(_LEADER_KEY)
            leads = bool(transaction.execute()[1] == holder.encode())
        if leads:
            self._connection.pexpire(_LEADER_KEY, milliseconds(ttl_s))
        return leads


def _key(name: str) -> str:
    return f"cleave:claim:{name}"
