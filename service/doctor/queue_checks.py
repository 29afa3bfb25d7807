"""Checks of the queue server: version, eviction, persistence, access, clock and workers."""

import time
from collections.abc import Iterator
from typing import Any
from urllib.parse import SplitResult, urlsplit, urlunsplit

from redis import Redis

from service.doctor.findings import Finding, error, ok, warning
from worker.jobs.queue.connection import QueueError, connect
from worker.jobs.queue.requirements import unmet_requirement
from worker.jobs.queue.workers import worker_counts
from worker.jobs.size_class import SizeClass

_OLDEST_VERSION = (6, 2)  # the first with BLMOVE, which rq uses to take an entry from a queue without losing it
_CLOCK_TOLERANCE_S = 2.0  # set by hand; NTP keeps clocks within a fraction of it
_LOOPBACK = ("", "localhost", "127.0.0.1", "::1")


def check_queue(url: str) -> list[Finding]:
    """Check the server of a URL, its settings and its workers."""
    with connect(url) as connection:
        try:
            reason = unmet_requirement(connection)
            if reason is not None:
                fault, _, remedy = reason.partition(": ")
                return [error("queue server", f"{fault}.", remedy[0].upper() + remedy[1:])]
            info: dict[str, Any] = connection.info()
            clock = connection.time()
            counts = worker_counts(connection)
        except QueueError as problem:
            return [
                error(
                    "queue server",
                    f"it does not answer: {problem}.",
                    "Start it, and check host, port and password in CLEAVE_REDIS_URL.",
                )
            ]
        return [
            *_version(info),
            _policy(info),
            *_persistence(info),
            _exposure(url, connection),
            check_clock("queue server's clock", float(clock[0]) + clock[1] / 1e6 - time.time()),
            *_workers(counts),
        ]


def check_clock(topic: str, ahead_s: float) -> Finding:
    """Check a clock that is ``ahead_s`` seconds ahead of the clock of this machine."""
    if abs(ahead_s) <= _CLOCK_TOLERANCE_S:
        return ok(topic, f"within {_CLOCK_TOLERANCE_S:.0f} s of the clock of this machine.")
    direction = "ahead of" if ahead_s > 0 else "behind"
    return warning(
        topic,
        f"{abs(ahead_s):.0f} s {direction} the clock of this machine.",
        "Synchronise the clocks of all machines (NTP).",
    )


def _version(info: dict[str, Any]) -> Iterator[Finding]:
    version = str(info["redis_version"])
    name = f"Valkey {info['valkey_version']}" if "valkey_version" in info else f"Redis {version}"
    numbers = tuple(int(part) for part in version.split(".")[:2])
    if numbers < _OLDEST_VERSION:
        yield error("queue server", f"{name} is too old.", "Use Valkey, or Redis 6.2 or newer.")
    else:
        yield ok("queue server", f"{name} answers.")


def _policy(info: dict[str, Any]) -> Finding:
    policy = str(info.get("maxmemory_policy", "noeviction"))
    if policy == "noeviction":
        return ok("queue server's memory", "nothing is ever evicted.")
    return error(
        "queue server's memory",
        f"maxmemory-policy is {policy}: entries of jobs are lost when memory is short.",
        "Set maxmemory-policy to noeviction, and use the server for nothing else.",
    )


def _persistence(info: dict[str, Any]) -> Iterator[Finding]:
    topic = "queue server's disk"
    if info.get("aof_enabled"):
        yield ok(topic, "the append-only file is on.")
    else:
        yield warning(
            topic,
            "the append-only file is off: after a crash jobs wait in another order, and counters restart at 0.",
            "Set appendonly to yes.",
        )
    for name in ("aof_last_write_status", "aof_last_bgrewrite_status", "rdb_last_bgsave_status"):
        if info.get(name, "ok") != "ok":
            yield error(
                topic,
                f"{name} is {info[name]}: it cannot write.",
                "Make room on its disk, and check the permissions of its folder.",
            )


def _exposure(url: str, connection: Redis) -> Finding:
    topic, parts = "queue server's access", urlsplit(url)
    if parts.scheme == "unix":
        return ok(topic, "a socket of this machine.")
    if not _allows_anonymous(parts):
        return ok(topic, "a password is required.")
    if _is_bound_to_loopback(parts, connection):
        return warning(
            topic,
            "it requires no password: every user of this machine can add and remove jobs.",
            "Set requirepass, and the password in CLEAVE_REDIS_URL.",
        )
    return error(
        topic,
        "it requires no password and listens to other machines: everyone who can reach it can add and remove jobs.",
        "Set requirepass, and the password in CLEAVE_REDIS_URL, and bind it to a private network.",
    )


def _allows_anonymous(parts: SplitResult) -> bool:
    """Whether the server answers without a password."""
    without = urlunsplit(parts._replace(netloc=parts.netloc.rpartition("@")[2]))
    try:
        with connect(without) as connection:
            return bool(connection.ping())
    except QueueError:
        return False


def _is_bound_to_loopback(parts: SplitResult, connection: Redis) -> bool:
    try:
        bound = str(connection.config_get("bind").get("bind", "*")).split()
    except QueueError:
        return parts.hostname in _LOOPBACK
    return bool(bound) and all(address.lstrip("-") in _LOOPBACK for address in bound)


def _workers(counts: dict[SizeClass, int]) -> Iterator[Finding]:
    for size, count in counts.items():
        if count:
            yield ok("workers", f"{count} for {size} jobs.")
        else:
            yield error("workers", f"none for {size} jobs is alive.", f"Start one: cleave worker --queue {size}")
