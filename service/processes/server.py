"""The process that answers HTTP, on a socket that its parent has opened."""

import socket
import sys

import uvicorn

from service.app import create_app
from service.impatience import ImpatientProtocol
from worker.logs import configure_logging
from worker.settings import load_settings

_DRAIN_S = 3  # for requests that are being answered when the process is told to stop


def main() -> None:
    """Serve on the listening socket whose descriptor is the first argument."""
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, "service")
    config = uvicorn.Config(
        create_app(settings),
        log_config=None,
        log_level="debug" if settings.log_level == "debug" else "warning",
        access_log=False,  # service.observed logs the requests
        server_header=False,
        http=ImpatientProtocol,
        timeout_graceful_shutdown=_DRAIN_S,
    )
    uvicorn.Server(config).run(sockets=[socket.socket(fileno=int(sys.argv[1]))])


if __name__ == "__main__":
    main()
