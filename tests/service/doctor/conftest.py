"""Queue servers with bad settings, for the checks to find."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from helpers.queue_servers import StartServer, queue_servers


@pytest.fixture
def start_server(tmp_path: Path) -> Iterator[StartServer]:
    """Start queue servers with options; the result is their URL."""
    with queue_servers(tmp_path) as start:
        yield start
