"""The process that serves HTTP, on a socket that its parent process has opened."""

import logging
import socket
import sys

import uvicorn
from fastapi import FastAPI

from cleave.logs import configure_logging
from cleave.settings import load_settings
from service.app import create_app
from service.host.http_protocol import MAX_HEAD_BYTES, HeadTimeoutProtocol

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


def main() -> None:
    """Serve on the listening socket whose file descriptor is the first argument."""
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, "service")
    logging.getLogger("uvicorn").setLevel("DEBUG" if settings.log_level == "debug" else "WARNING")
    uvicorn.Server(server_config(create_app(settings))).run(sockets=[socket.socket(fileno=int(sys.argv[1]))])


if __name__ == "__main__":
    main()
