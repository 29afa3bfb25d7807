"""A folder that is the root of a system: mounts in it, and commands that run in it."""

import os
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

_DEVICES = ("null", "zero", "full", "random", "urandom", "tty")


@dataclass(frozen=True, slots=True)
class Root:
    """The root of a system.

    Mounting requires root, and a mount namespace of its own, whose end unmounts everything.
    """

    folder: Path

    def path(self, inside: str) -> Path:
        """Return the path outside of this root for a path inside."""
        return self.folder / inside.lstrip("/")

    def mount_system(self) -> None:
        """Mount /proc, /dev with a few devices, and shared memory."""
        self._mount("proc", "/proc")
        self._mount("tmpfs", "/dev", "mode=755")
        for name in _DEVICES:
            self.bind(Path("/dev") / name, f"/dev/{name}")
        self.path("/dev/shm").mkdir()
        self._mount("tmpfs", "/dev/shm", "mode=1777")

    def bind(self, outside: Path, inside: str) -> None:
        """Mount a file or folder of this machine at a path, read-only."""
        target = self.path(inside)
        target.parent.mkdir(parents=True, exist_ok=True)
        if outside.is_dir():
            target.mkdir(exist_ok=True)
        else:
            target.unlink(missing_ok=True)
            target.touch()
        subprocess.run(["mount", "--bind", outside, target], check=True)
        subprocess.run(["mount", "-o", "remount,bind,ro", target], check=True)

    def bind_network(self) -> None:
        """Let commands resolve host names."""
        self.bind(Path("/etc/resolv.conf"), "/etc/resolv.conf")

    def make_read_only(self, writable: Mapping[str, str]) -> None:
        """Make the root read-only, except for file systems in memory.

        Parameters
        ----------
        writable : their paths, and the mount options of each.
        """
        subprocess.run(["mount", "--bind", self.folder, self.folder], check=True)
        subprocess.run(["mount", "-o", "remount,bind,ro", self.folder], check=True)
        for inside, options in writable.items():
            self._mount("tmpfs", inside, options)

    def command(
        self, words: Sequence[str], environment: Mapping[str, str], folder: str = "/", user: str = "0:0"
    ) -> list[str]:
        """Return the command line that runs a command in this root, as a user who cannot gain privileges."""
        variables = [f"{name}={value}" for name, value in environment.items()]
        enter = ["chroot", f"--userspec={user}", f"--groups={user.partition(':')[2]}", str(self.folder)]
        return [*enter, "env", "-i", "-C", folder, *variables, "setpriv", "--no-new-privs", *words]

    def run(self, words: Sequence[str], environment: Mapping[str, str], folder: str = "/", user: str = "0:0") -> str:
        """Run a command and return its standard output."""
        command = self.command(words, environment, folder, user)
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout

    def _mount(self, kind: str, inside: str, options: str = "nosuid") -> None:
        subprocess.run(["mount", "-t", kind, "-o", options, kind, self.path(inside)], check=True)


def copy_of(root: Path, folder: Path) -> Root:
    """Copy a root."""
    subprocess.run(["cp", "-a", "--reflink=auto", "--one-file-system", root, folder], check=True)
    return Root(folder)


def copy_into(source: Path, target: Path) -> None:
    """Copy a file, or the content of a folder, into a folder, with owners, modes and times."""
    if source.is_dir():
        target.mkdir(parents=True, exist_ok=True)
        subprocess.run(["cp", "-a", f"{source}/.", target], check=True)
    else:
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, target / source.name if os.path.isdir(target) else target)
