"""A folder that is the root of a system: commands that run in it, and what it sees of this machine."""

import os
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

_DEVICES = ("null", "zero", "full", "random", "urandom", "tty")


@dataclass(frozen=True, slots=True)
class Root:
    """Needs the rights of root, and a mount namespace of its own that takes the mounts along when it ends."""

    folder: Path

    def path(self, inside: str) -> Path:
        """Where a path of this root is from outside."""
        return self.folder / inside.lstrip("/")

    def mount_system(self) -> None:
        """What every process expects: its processes, a few devices, shared memory."""
        self._mount("proc", "/proc")
        self._mount("tmpfs", "/dev", "mode=755")
        for name in _DEVICES:
            self.bind(Path("/dev") / name, f"/dev/{name}")
        self.path("/dev/shm").mkdir()
        self._mount("tmpfs", "/dev/shm", "mode=1777")

    def bind(self, outside: Path, inside: str) -> None:
        """Show a file or folder of this machine under a path, to be read."""
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
        """Let commands find other machines by name."""
        self.bind(Path("/etc/resolv.conf"), "/etc/resolv.conf")

    def make_read_only(self, writable: Mapping[str, str]) -> None:
        """Refuse every change from now on, but in memory under these paths, whose mounts have options."""
        subprocess.run(["mount", "--bind", self.folder, self.folder], check=True)
        subprocess.run(["mount", "-o", "remount,bind,ro", self.folder], check=True)
        for inside, options in writable.items():
            self._mount("tmpfs", inside, options)

    def command(
        self, words: Sequence[str], environment: Mapping[str, str], folder: str = "/", user: str = "0:0"
    ) -> list[str]:
        """The command line that runs a command in here, as a user who cannot become another."""
        variables = [f"{name}={value}" for name, value in environment.items()]
        enter = ["chroot", f"--userspec={user}", f"--groups={user.partition(':')[2]}", str(self.folder)]
        return [*enter, "env", "-i", "-C", folder, *variables, "setpriv", "--no-new-privs", *words]

    def run(self, words: Sequence[str], environment: Mapping[str, str], folder: str = "/", user: str = "0:0") -> str:
        """Run a command to its end; what it wrote to its standard output."""
        command = self.command(words, environment, folder, user)
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout

    def _mount(self, kind: str, inside: str, options: str = "nosuid") -> None:
        subprocess.run(["mount", "-t", kind, "-o", options, kind, self.path(inside)], check=True)


def copy_of(root: Path, folder: Path) -> Root:
    """A root with the same files."""
    subprocess.run(["cp", "-a", "--reflink=auto", "--one-file-system", root, folder], check=True)
    return Root(folder)


def copy_into(source: Path, target: Path) -> None:
    """Copy a file, or what is in a folder, with owners, modes and times."""
    if source.is_dir():
        target.mkdir(parents=True, exist_ok=True)
        subprocess.run(["cp", "-a", f"{source}/.", target], check=True)
    else:
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, target / source.name if os.path.isdir(target) else target)
