"""nginx and Caddy in front of a service, with the configurations of deploy/."""

import os
import shutil
import socket
import ssl
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx

from bench.checkout import HERE
from bench.errors import BenchmarkError

PATH = "/cleave"  # below which the configurations of deploy/proxies show the service
_STARTED_WITHIN_S = 30.0


@dataclass(frozen=True, slots=True)
class Place:
    """Where a proxy runs on this machine, and what it leads to."""

    folder: Path
    backend: str  # host and port of the service
    port: int  # for TLS
    plain_port: int

    @property
    def certificate(self) -> Path:
        """The file with the key and the certificate for localhost."""
        return self.folder / "localhost.pem"


@dataclass(frozen=True, slots=True)
class ProxyKind:
    """A program with one of the configurations."""

    program: str
    path: str  # below which it shows the service
    command: Callable[[Place], list[str]]  # writes the configuration to the folder and returns the command line


@dataclass(frozen=True, slots=True)
class Proxy:
    """A proxy that runs. The URLs are those below which it shows the service."""

    url: str
    plain_url: str  # without TLS
    trust: ssl.SSLContext  # which accepts its certificate


def _nginx(place: Place) -> list[str]:
    folder = place.folder
    paths = [f"{kind}_temp_path {folder}/{kind};" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")]
    changes = {
        "127.0.0.1:8000": place.backend,
        "listen 80;": f"listen 127.0.0.1:{place.plain_port};",
        "listen 443 ssl;": f"listen 127.0.0.1:{place.port} ssl;",
        "/etc/letsencrypt/live/example.com/fullchain.pem": str(place.certificate),
        "/etc/letsencrypt/live/example.com/privkey.pem": str(place.certificate),
    }
    text = f"daemon off; pid {folder}/pid; error_log {folder}/log; events {{}}\n"
    text += f"http {{ access_log off; {' '.join(paths)}\n{_changed('proxies/nginx.conf', changes)} }}"
    (folder / "nginx.conf").write_text(text)
    return ["nginx", "-p", str(folder), "-c", str(folder / "nginx.conf")]


def _caddy(place: Place) -> list[str]:
    changes = {"127.0.0.1:8000": place.backend, "example.com {": _site(place)}
    return _with_caddyfile(place, _changed("proxies/Caddyfile", changes))


def _caddy_of_compose(place: Place) -> list[str]:
    changes = {"{$UPSTREAM}": place.backend, "{$SITE_ADDRESS} {": _site(place)}
    return _with_caddyfile(place, _changed("compose/Caddyfile", changes))


NGINX = ProxyKind("nginx", PATH, _nginx)
CADDY = ProxyKind("caddy", PATH, _caddy)
CADDY_OF_COMPOSE = ProxyKind("caddy", "", _caddy_of_compose)


@contextmanager
def proxied(kind: ProxyKind, folder: Path, backend: str) -> Iterator[Proxy]:
    """Run a proxy in front of the service with the URL ``backend``.

    Raises
    ------
    BenchmarkError
        If the program or the package trustme is not installed, or the program does not start.
    """
    if shutil.which(kind.program) is None:
        raise BenchmarkError(f"There is no {kind.program}: install Debian's package of that name.")
    place = Place(folder, backend.removeprefix("http://"), free_port(), free_port())
    trust = _certified(place)
    url, plain_url = f"https://localhost:{place.port}", f"http://localhost:{place.plain_port}"
    environment = os.environ | {"HOME": str(folder), "XDG_DATA_HOME": str(folder), "XDG_CONFIG_HOME": str(folder)}
    with subprocess.Popen(kind.command(place), env=environment, stderr=subprocess.DEVNULL) as process:
        try:
            _wait_until_it_answers(url, trust, kind.program)
            yield Proxy(url + kind.path, plain_url + kind.path, trust)
        finally:
            process.terminate()


def free_port() -> int:
    """Return a port on which nothing listens."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        return int(free.getsockname()[1])


def _certified(place: Place) -> ssl.SSLContext:
    """Write a certificate for localhost, and return a context that accepts it."""
    try:
        import trustme
    except ImportError as error:
        raise BenchmarkError("trustme is missing: pip install '.[test]'.") from error
    authority = trustme.CA()
    authority.issue_cert("localhost").private_key_and_cert_chain_pem.write_to_path(str(place.certificate))
    context = ssl.create_default_context()
    authority.configure_trust(context)
    return context


def _site(place: Place) -> str:
    return f"localhost {{\n\ttls {place.certificate} {place.certificate}"


def _with_caddyfile(place: Place, text: str) -> list[str]:
    options = f"{{\n\tadmin off\n\thttp_port {place.plain_port}\n\thttps_port {place.port}\n}}\n"
    (place.folder / "Caddyfile").write_text(options + text)
    return ["caddy", "run", "--adapter", "caddyfile", "--config", str(place.folder / "Caddyfile")]


def _changed(file: str, changes: Mapping[str, str]) -> str:
    """Return the text of a file of deploy/ with the places of this machine."""
    text = (HERE / "deploy" / file).read_text()
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    return text


def _wait_until_it_answers(url: str, trust: ssl.SSLContext, name: str) -> None:
    """Wait for any answer of the proxy itself, whether the service runs or not."""
    deadline = time.monotonic() + _STARTED_WITHIN_S
    while time.monotonic() < deadline:
        try:
            httpx.get(url, verify=trust)
            return
        except httpx.TransportError:
            time.sleep(0.05)
    raise BenchmarkError(f"{name} does not start.")
