"""Several hosts on one machine: network namespaces on a bridge, which can be disconnected."""

import os
import shutil
import signal
import subprocess
import tempfile
from contextlib import suppress
from pathlib import Path

from helpers.processes import children_of, is_alive
from helpers.waiting import wait_until

# A network of the range that RFC 2544 reserves for tests, chosen by process id so that test runs do not collide.
_NETWORK = f"198.{18 + os.getpid() // 256 % 2}.{os.getpid() % 256}"
_HUB, _TESTER = f"{_NETWORK}.1", f"{_NETWORK}.254"


def can_make_hosts() -> bool:
    """Whether this user can create network namespaces."""
    if os.geteuid() != 0 or shutil.which("ip") is None:
        return False
    name = f"cleave-{os.getpid()}"
    made = subprocess.run(["ip", "netns", "add", name], capture_output=True, check=False).returncode == 0
    if made:
        _ip("netns", "del", name)
    return made


class Host:
    """A network namespace that is connected to the hub, with its own folder and processes."""

    def __init__(self, namespace: str, address: str, folder: Path) -> None:
        self.namespace = namespace
        self.address = address
        self.folder = folder
        self.processes: list[subprocess.Popen[bytes]] = []
        folder.mkdir()

    def start(self, command: list[str], **environment: str) -> "subprocess.Popen[bytes]":
        process = subprocess.Popen(
            ["ip", "netns", "exec", self.namespace, *command],
            env=os.environ | environment,
            stdout=subprocess.DEVNULL,
            start_new_session=True,
        )
        self.processes.append(process)
        return process

    def unplug(self) -> None:
        _ip("-n", self.namespace, "link", "set", "cable", "down")

    def plug_in(self) -> None:
        _ip("-n", self.namespace, "link", "set", "cable", "up")

    def tree(self) -> list[int]:
        """Return the living processes of this host and all their descendants."""
        found = [process.pid for process in self.processes]
        for pid in found:
            found += children_of(pid)
        return [pid for pid in found if is_alive(pid)]


class Network:
    """A hub with its hosts, to which this process is connected too. Leaving its context removes all of them."""

    def __init__(self) -> None:
        self._prefix = f"cleave-{os.getpid()}"
        self._folder = Path(tempfile.mkdtemp(prefix="cleave-hosts-"))
        self._guest = f"clv{os.getpid()}"
        self._hosts: list[Host] = []

    def __enter__(self) -> "Network":
        self.hub = self._add("hub", _HUB)
        _ip("-n", self.hub.namespace, "link", "add", "name", "bridge", "type", "bridge")
        _ip("-n", self.hub.namespace, "address", "add", f"{_HUB}/24", "dev", "bridge")
        _ip("-n", self.hub.namespace, "link", "set", "bridge", "up")
        _ip("link", "add", self._guest, "type", "veth", "peer", "name", "guest", "netns", self.hub.namespace)
        _ip("address", "add", f"{_TESTER}/24", "dev", self._guest)
        _ip("link", "set", self._guest, "up")
        self._join_bridge("guest")
        return self

    def __exit__(self, *_: object) -> None:
        for pid in [pid for host in self._hosts for pid in host.tree()]:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        for host in self._hosts:
            for process in host.processes:
                process.wait()
            wait_until(lambda host=host: not _processes_in(host.namespace), within_s=20)
            _ip("netns", "del", host.namespace)
        shutil.rmtree(self._folder)

    def add_host(self, name: str) -> Host:
        """Add a connected host."""
        host = self._add(name, f"{_NETWORK}.{len(self._hosts) + 10}")
        _ip(
            "link",
            "add",
            "cable",
            "netns",
            host.namespace,
            "type",
            "veth",
            "peer",
            "name",
            name,
            "netns",
            self.hub.namespace,
        )
        _ip("-n", host.namespace, "address", "add", f"{host.address}/24", "dev", "cable")
        host.plug_in()
        self._join_bridge(name)
        return host

    def _add(self, name: str, address: str) -> Host:
        host = Host(f"{self._prefix}-{name}", address, self._folder / name)
        _ip("netns", "add", host.namespace)
        self._hosts.append(host)
        _ip("-n", host.namespace, "link", "set", "lo", "up")
        return host

    def _join_bridge(self, port: str) -> None:
        _ip("-n", self.hub.namespace, "link", "set", port, "master", "bridge")
        _ip("-n", self.hub.namespace, "link", "set", port, "up")


def _processes_in(namespace: str) -> list[str]:
    return subprocess.run(["ip", "netns", "pids", namespace], capture_output=True, text=True, check=True).stdout.split()


def _ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, capture_output=True)
