"""The process that serves HTTP, on a socket that its parent process has opened."""

import logging
import os
import socket
import sys
import threading
from importlib import import_module

import uvicorn
from fastapi import FastAPI

from cleave.logs import configure_logging
from cleave.settings import load_settings
from service.app import create_app
from service.host.http_protocol import MAX_HEAD_BYTES, HeadTimeoutProtocol

_USED_SOON = "segcore.io.keeping"  # by the first request for a model; imported with what it needs after the start
_DRAIN_S = 3  # that requests have to finish after SIGTERM: less than the grace_s of the supervisor, which then kills


def server_config(app: FastAPI) -> uvicorn.Config:
    """Return the configuration of uvicorn for the application."""
    return uvicorn.Config(
        app,
        log_config=None,
        access_log=False,  # service.telemetry.request_log logs the requests
        server_header=False,
        http=HeadTimeoutProtocol,
        h11_max_incomplete_event_size=MAX_HEAD_BYTES,
        timeout_graceful_shutdown=_DRAIN_S,
    )


class _Server(uvicorn.Server):
    """A server that tells its parent process when it has started."""

    def __init__(self, config: uvicorn.Config, descriptor: int) -> None:
        super().__init__(config)
        self._descriptor = descriptor

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        os.write(self._descriptor, b"1")
        threading.Thread(target=import_module, args=[_USED_SOON], daemon=True).start()


def main() -> None:
    """Serve on the listening socket whose file descriptor is the first argument.

    The second argument is a file descriptor to which a byte is written when the server has started.
    """
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, "service")
    logging.getLogger("uvicorn").setLevel("DEBUG" if settings.log_level == "debug" else "WARNING")
    listening, started = map(int, sys.argv[1:])
    _Server(server_config(create_app(settings)), started).run(sockets=[socket.socket(fileno=listening)])


if __name__ == "__main__":
    main()
