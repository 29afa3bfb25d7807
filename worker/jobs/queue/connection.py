"""Connections to Redis: one that fails soon, and one that retries for minutes."""

from redis import Redis
from redis.backoff import ExponentialBackoff, NoBackoff
from redis.exceptions import RedisError
from redis.retry import Retry

QueueError = RedisError


def connect(url: str, timeout_s: float = 0.9) -> Redis:
    """Return a connection whose commands fail after at most two timeouts, as they are retried once.

    The default keeps them below the two seconds within which the API answers if Redis hangs.
    """
    return Redis.from_url(url, socket_timeout=timeout_s, socket_connect_timeout=timeout_s, retry=Retry(NoBackoff(), 1))


def connect_with_retries(url: str) -> Redis:
    """Return a connection for the main loop of a worker, which can do nothing without the queue.

    150 retries with pauses of up to 2 s are about five minutes. The socket timeout is longer than the 5 s for which rq
    blocks on an empty queue.
    """
    return Redis.from_url(
        url,
        socket_timeout=30.0,
        socket_connect_timeout=5.0,
        health_check_interval=30,
        retry=Retry(ExponentialBackoff(cap=2.0, base=0.1), 150),
    )


def close_inherited(connection: Redis) -> None:
    """Close what a child process has of the sockets of its parent, which keeps its own; a later command connects anew.

    Otherwise the server does not notice that the parent has died as long as the child lives.
    """
    connection.connection_pool.disconnect()


def text_of(answer: bytes | str) -> str:
    return answer.decode() if isinstance(answer, bytes) else answer


def milliseconds(seconds: float) -> int:
    """Return a time to live as Redis takes it: whole milliseconds, at least one."""
    return max(1, round(1000 * seconds))
