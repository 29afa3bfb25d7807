"""The process that answers HTTP, on a socket that its parent has opened."""

import logging
import socket
import sys

import uvicorn
from fastapi import FastAPI

from cleave.logs import configure_logging
from cleave.settings import load_settings
from service.app import create_app
from service.host.http_protocol import LONGEST_HEAD_BYTES, ImpatientProtocol

_DRAIN_S = 3  # for requests that are being answered when the process is told to stop


def server_config(app: FastAPI) -> uvicorn.Config:
    """How the application is served."""
    return uvicorn.Config(
        app,
        log_config=None,
        access_log=False,  # service.telemetry.request_log logs the requests
        server_header=False,
        http=ImpatientProtocol,
        h11_max_incomplete_event_size=LONGEST_HEAD_BYTES,
        timeout_graceful_shutdown=_DRAIN_S,
    )


def main() -> None:
    """Serve on the listening socket whose descriptor is the first argument."""
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, "service")
    logging.getLogger("uvicorn").setLevel("DEBUG" if settings.log_level == "debug" else "WARNING")
    uvicorn.Server(server_config(create_app(settings))).run(sockets=[socket.socket(fileno=int(sys.argv[1]))])


if __name__ == "__main__":
    main()
