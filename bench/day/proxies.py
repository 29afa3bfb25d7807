"""nginx and Caddy in front of a service, with the configurations of docs/how-to/proxies.md."""

import os
import re
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx

from bench.checkout import HERE
from bench.errors import BenchmarkError

PATH = "/cleave"  # below which the configurations show the service
_GUIDE = HERE / "docs" / "how-to" / "proxies.md"
_STARTED_WITHIN_S = 30.0

Command = Callable[[Path, str, int], list[str]]  # takes a folder, the URL of the service, and a port


def nginx(folder: Path, backend: str, port: int) -> list[str]:
    """Write the configuration of nginx to a folder and return its command line."""
    paths = [f"{kind}_temp_path {folder}/{kind};" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")]
    server = _configuration("nginx", backend, port)
    text = f"daemon off; pid {folder}/pid; error_log {folder}/log; events {{}}\n"
    text += f"http {{ access_log off; {' '.join(paths)}\n{server} }}"
    (folder / "nginx.conf").write_text(text)
    return ["nginx", "-p", str(folder), "-c", str(folder / "nginx.conf")]


def caddy(folder: Path, backend: str, port: int) -> list[str]:
    """Write the configuration of Caddy to a folder and return its command line."""
    (folder / "Caddyfile").write_text("{\n admin off\n}\n" + _configuration("caddy", backend, port))
    return ["caddy", "run", "--adapter", "caddyfile", "--config", str(folder / "Caddyfile")]


@contextmanager
def proxied(command: Command, folder: Path, backend: str) -> Iterator[str]:
    """Run a proxy and yield the URL below which it shows the service.

    Raises
    ------
    BenchmarkError
        If the program is not installed, or does not start.
    """
    name = command.__name__
    if shutil.which(name) is None:
        raise BenchmarkError(f"There is no {name}: install Debian's package of that name.")
    port = free_port()
    environment = os.environ | {"HOME": str(folder), "XDG_DATA_HOME": str(folder), "XDG_CONFIG_HOME": str(folder)}
    with subprocess.Popen(command(folder, backend, port), env=environment, stderr=subprocess.DEVNULL) as process:
        try:
            _wait_until_it_answers(f"http://localhost:{port}", name)
            yield f"http://localhost:{port}{PATH}"
        finally:
            process.terminate()


def free_port() -> int:
    """Return a port on which nothing listens."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        return int(free.getsockname()[1])


def _configuration(language: str, backend: str, port: int) -> str:
    found = re.search(rf"```{language}\n(.*?)```", _GUIDE.read_text(), re.DOTALL)
    assert found, language
    text = found[1].replace("127.0.0.1:8000", backend.removeprefix("http://"))
    return text.replace("listen 80", f"listen 127.0.0.1:{port}").replace("localhost:80", f"localhost:{port}")


def _wait_until_it_answers(url: str, name: str) -> None:
    """Wait for any answer of the proxy itself, whether the service runs or not."""
    deadline = time.monotonic() + _STARTED_WITHIN_S
    while time.monotonic() < deadline:
        try:
            httpx.get(url)
            return
        except httpx.TransportError:
            time.sleep(0.05)
    raise BenchmarkError(f"{name} does not start.")
