"""This machine: its limits against the settings, what is installed, and who is let in."""

import os
import platform
import resource
from collections.abc import Iterator
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

from cleave.settings import InvalidSettings, Settings
from cleave.version import installed_version
from service.commands.serve import check_guarded
from service.doctor.findings import Finding, error, ok, warning

_CONNECTIONS = 1024  # that wait to be taken, besides those that are answered
_BYTES_PER_FACE, _BYTES_AT_LEAST = 400, 500 * 2**20  # of a work-horse, measured on large meshes
_PACKAGES = ("numpy", "scipy", "numba", "redis", "rq", "fastapi", "uvicorn", "trimesh")
_CLIENTS_VARIABLES = ("CLEAVE_API_KEY",)  # of the commands that speak to a service
_CONTROL_GROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


def check_machine(settings: Settings, host: str) -> list[Finding]:
    """What the processes of an installation find here, which listens on ``host``."""
    return [
        *_open_files(),
        *_file_size(settings),
        *_memory(settings),
        *_kernels(),
        *_access(settings, host),
        *_unknown_variables(),
        ok("versions", f"Cleave {installed_version()}, Python {platform.python_version()}, {_installed()}."),
    ]


def _open_files() -> Iterator[Finding]:
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    if most != resource.RLIM_INFINITY and most < _CONNECTIONS:
        yield warning(
            "open files",
            f"a process may have {most}: more clients than that are turned away.",
            f"Raise the limit (ulimit -n {8 * _CONNECTIONS}, or LimitNOFILE of the service).",
        )
    else:
        yield ok("open files", "enough for many clients.")


def _file_size(settings: Settings) -> Iterator[Finding]:
    most = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    if most != resource.RLIM_INFINITY and most < settings.max_upload_bytes:
        yield error(
            "file size",
            f"a file may have {most} bytes: large meshes are cut off.",
            "Raise the limit (ulimit -f unlimited).",
        )


def _memory(settings: Settings) -> Iterator[Finding]:
    needed, there = _BYTES_AT_LEAST + _BYTES_PER_FACE * settings.max_faces, memory_bytes()
    given = min(there, settings.job_memory_bytes)
    if given < needed:
        yield warning(
            "memory",
            f"a job may use {given / 2**30:.1f} GiB, and {settings.max_faces} faces take about {needed / 2**30:.1f}.",
            f"Lower CLEAVE_MAX_FACES to {max(1, (given - _BYTES_AT_LEAST) // _BYTES_PER_FACE)}, or give more memory.",
        )
    else:
        yield ok("memory", f"enough for one job of {settings.max_faces} faces at a time.")
    if settings.job_memory_bytes > there:
        yield warning(
            "memory of a job",
            f"a job may take {settings.job_memory_bytes / 2**30:.1f} GiB, of {there / 2**30:.1f}: one file can "
            "have the kernel kill other processes.",
            "Lower CLEAVE_JOB_MEMORY_BYTES.",
        )


def memory_bytes() -> int:
    """What this machine, or the container, has."""
    limits = [os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")]
    for path in _CONTROL_GROUP_LIMITS:
        with suppress(OSError, ValueError):
            limits.append(int(Path(path).read_text()))
    return min(limits)


def _kernels() -> Iterator[Finding]:
    shipped = os.environ.get("NUMBA_CACHE_DIR")
    folder = Path(shipped) if shipped else Path(__file__).parents[2] / "segcore"
    compiled = sum(1 for _ in folder.rglob("*.nbi"))
    if compiled:
        yield ok("kernels", f"{compiled} are compiled, in {folder}.")
    else:
        yield warning(
            "kernels",
            "none is compiled: the first start takes up to a minute.",
            'Start it once, or run python -c "import segcore; segcore.warm_up()"',
        )


def _access(settings: Settings, host: str) -> Iterator[Finding]:
    try:
        check_guarded(settings, host)
    except InvalidSettings as problem:
        yield error("access", f"the service does not start on {host}.", str(problem))
        return
    if settings.auth == "off" and not host.startswith("127.") and host != "::1":
        yield warning(
            "access",
            f"whoever reaches {host} can use the service: CLEAVE_AUTH is off.",
            "Make API keys with `cleave key NAME`, unless something else keeps strangers out.",
        )
    else:
        yield ok("access", f"on {host} the service lets in whom it should.")


def _unknown_variables() -> Iterator[Finding]:
    known = {f"CLEAVE_{name.upper()}" for name in Settings.model_fields}
    for name in sorted(name for name in os.environ if name.startswith("CLEAVE_")):
        if name not in known and name not in _CLIENTS_VARIABLES:
            yield warning("settings", f"{name} is none.", "Look for its right name in `cleave serve --help`.")


def _installed() -> str:
    return ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
