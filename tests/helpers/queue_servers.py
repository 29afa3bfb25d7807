"""Queue servers with other options than the embedded one, on TCP ports."""

import socket
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeAlias

from redis import Redis
from redis.exceptions import RedisError

from helpers.waiting import wait_until
from service.host.queue_server import find_server_binary

StartServer: TypeAlias = Callable[..., str]


@contextmanager
def queue_servers(folder: Path) -> Iterator[StartServer]:
    """Yield a function that starts a server with options and returns its URL."""
    started: list[subprocess.Popen[bytes]] = []

    def start(**options: str) -> str:
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = str(free.getsockname()[1])
        given = {"port": port, "dir": str(folder), "save": "", "logfile": str(folder / "log")}
        words = [word for name, value in (given | options).items() for word in (f"--{name.replace('_', '-')}", value)]
        started.append(subprocess.Popen([str(find_server_binary()), *words]))
        password = options.get("requirepass")
        url = f"redis://:{password}@127.0.0.1:{port}/0" if password else f"redis://127.0.0.1:{port}/0"
        wait_until(lambda: _is_answering(url))
        return url

    try:
        yield start
    finally:
        for process in started:
            process.kill()
            process.wait()


def _is_answering(url: str) -> bool:
    with Redis.from_url(url) as connection:
        try:
            return bool(connection.ping())
        except RedisError:
            return False
