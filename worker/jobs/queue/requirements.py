"""What the queue server must be and must allow, checked before anything relies on it."""

import re
import secrets
from collections.abc import Iterator

from redis import Redis
from redis.exceptions import NoPermissionError, ResponseError

_PREFIXES = ("cleave:", "rq:")  # of all keys
_COMMAND = re.compile(r"'([^']+)'")
# Every command that the queue uses, by the words of one call that changes nothing that lasts; KEY is a key.
_CALLS = (
    "TIME",
    "CLIENT INFO",
    "SCAN 0 COUNT 1",
    "EVAL return(1) 0",
    "SET KEY 1 PX 1000",
    "GET KEY",
    "MGET KEY",
    "EXISTS KEY",
    "EXPIRE KEY 1",
    "PEXPIRE KEY 1000",
    "DEL KEY",
    "RPUSH KEY a",
    "LPUSH KEY a",
    "LLEN KEY",
    "LINDEX KEY 0",
    "LPOS KEY a",
    "LRANGE KEY 0 0",
    "LMOVE KEY KEY LEFT LEFT",
    "BLMOVE KEY KEY LEFT LEFT 0.001",
    "LREM KEY 0 a",
    "DEL KEY",
    "SADD KEY a",
    "SMEMBERS KEY",
    "SREM KEY a",
    "HSET KEY a 1",
    "HGETALL KEY",
    "HINCRBYFLOAT KEY a 1",
    "DEL KEY",
    "ZADD KEY 1 a",
    "ZRANGE KEY 0 0",
    "ZREM KEY a",
    "DEL KEY",
)


def unmet_requirement(connection: Redis) -> str | None:
    """Return a sentence that says why a server cannot be used; None if it can.

    Raises
    ------
    QueueError
        If it does not answer.
    """
    missing = sorted(set(_missing_rights(connection)))
    if missing:
        rights = f"ACL SETUSER NAME +@all {' '.join(f'~{prefix}*' for prefix in _PREFIXES)}"
        return (
            f"The user of CLEAVE_REDIS_URL may not use {', '.join(missing)} on the queue server: allow it, for example "
            f"with {rights}."
        )
    if connection.info("cluster").get("cluster_enabled"):
        return "The queue server is a Redis cluster, which rq cannot use: set CLEAVE_REDIS_URL to a single server."
    return None


def _missing_rights(connection: Redis) -> Iterator[str]:
    calls = [("INFO", "")] + [(call, prefix) for prefix in _PREFIXES for call in _CALLS]
    name = f"probe:{secrets.token_hex(8)}"
    for call, prefix in calls:
        words = [f"{prefix}{name}" if word == "KEY" else word for word in call.split()]
        try:
            connection.execute_command(*words)  # type: ignore[no-untyped-call]
        except NoPermissionError as error:
            command = _COMMAND.search(str(error))
            yield command[1].upper().replace("|", " ") if command else f"keys that begin with {prefix}"
        except ResponseError:
            continue  # such as MOVED of a cluster; the right is there
