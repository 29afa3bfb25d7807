"""The listening socket of the service."""

import os
import socket

BACKLOG = 1024  # connections that the kernel completes before the process accepts them; set by hand


class CannotListen(Exception):  # noqa: N818
    """The address cannot be listened on; the message contains the reason."""


def listen(host: str, port: int) -> socket.socket:
    """Return a listening socket; port 0 chooses a free port.

    Raises
    ------
    CannotListen
        If the host is not an address of this machine, or the port is in use.
    """
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        return socket.create_server(address[:2], family=family, backlog=BACKLOG)
    except OSError as error:
        # create_server adds the address to the text of the system, which would say it twice.
        reason = error.strerror if isinstance(error, socket.gaierror) else os.strerror(error.errno or 0)
        raise CannotListen(f"Cannot listen on {host} port {port}: {reason}.") from error


def url_of(listening: socket.socket) -> str:
    """Return the URL of the service on a listening socket."""
    host, port = listening.getsockname()[:2]
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"
