"""The files of the embedded queue server, after they were damaged, for example by a loss of power.

The queue is disposable: the store knows every job, and the janitor enqueues those that the queue has lost.
"""

import logging
import os
import shutil
from pathlib import Path

log = logging.getLogger("cleave.supervisor")

_CHANGES = "appendonlydir"  # the server's name of the folder of its append-only files
_SET_ASIDE = "damaged"
_LOG = "server.log"
_TAIL = 2**16  # bytes of the log that are searched for the latest start, which writes about 1 KB
_STARTS, _READY = b"is starting", b"Ready to accept connections"


def set_aside_unreadable(folder: Path, status: int) -> None:
    """Move the files of a server that has ended out of the way if it ended before it was ready.

    The server then starts with an empty queue. Files that were set aside earlier are removed.

    Parameters
    ----------
    folder : of the files of the server.
    status : its exit status, or the negated number of the signal that ended it.
    """
    changes = folder / _CHANGES
    if status == 0 or not changes.exists() or _was_ready(folder / _LOG):
        return
    aside = folder / _SET_ASIDE
    shutil.rmtree(aside, ignore_errors=True)
    os.replace(changes, aside)
    log.warning(
        "the queue server could not read its files in %s: they are now in %s, and the queue is filled from the store",
        changes,
        aside,
    )


def _was_ready(server_log: Path) -> bool:
    """Whether the latest start in a log reached the state in which the server takes connections."""
    try:
        with server_log.open("rb") as file:
            file.seek(max(file.seek(0, os.SEEK_END) - _TAIL, 0))
            tail = file.read()
    except FileNotFoundError:
        return False
    return _READY in tail[max(tail.rfind(_STARTS), 0) :]
