"""Logs the files that a Python process opens and the addresses that it connects to, by an audit hook."""

import os
import sys

_LOG = os.open(os.environ["AUDIT_LOG"], os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC)
_SEEN: set[bytes] = set()
_EVENTS = {
    "open": 0,
    "os.listdir": 0,
    "os.scandir": 0,
    "os.rename": 1,
    "os.link": 1,
    "os.mkdir": 0,
    "socket.connect": 1,
    "socket.bind": 1,
    "socket.getaddrinfo": 0,
    "subprocess.Popen": 0,
    "os.exec": 0,
    "os.posix_spawn": 0,
}


def _note(event: str, arguments: tuple[object, ...]) -> None:
    if event in _EVENTS:
        what = arguments[_EVENTS[event]]
        line = f"{event}\t{what.decode() if isinstance(what, bytes) else what}".encode("utf-8", "replace")
        if line not in _SEEN:
            _SEEN.add(line)
            os.write(_LOG, line.replace(b"\n", b" ") + b"\n")


sys.addaudithook(_note)
