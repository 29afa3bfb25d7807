"""Checks of this machine: its limits, installed packages, access to the service, and unknown settings."""

import os
import platform
import resource
from collections.abc import Iterator
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from cleave.settings import InvalidSettings, Settings, unknown_variables
from cleave.version import extra_command, installed_version
from service.doctor.extras import missing_extras
from service.doctor.findings import Finding, error, ok, warning
from service.guard.exposure import check_exposure
from service.host.kernel_cache import compiled_kernels
from service.host.listening import BACKLOG

# Memory of a work-horse. bench/RESULTS.md measures 398 to 411 bytes per face on meshes of 200,000 faces and more (its
# table of stages); the rest is what it needs on a small mesh (docs/operations.md, Sizing) and a reserve, set by hand.
_BYTES_PER_FACE, _BASE_BYTES = 400, 500 * 2**20
_PACKAGES = ("numpy", "scipy", "numba", "redis", "rq", "fastapi", "uvicorn", "trimesh")
_CGROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


def check_machine(settings: Settings, host: str) -> list[Finding]:
    """Check this machine, on which the service listens on the address ``host``."""
    return [
        *_open_files(),
        *_file_size(settings),
        *_memory(settings),
        *_kernels(),
        *_access(settings, host),
        *_unknown_variables(),
        _extras(),
        ok("versions", f"Cleave {installed_version()}, Python {platform.python_version()}, {_installed()}."),
    ]


def _open_files() -> Iterator[Finding]:
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    if most != resource.RLIM_INFINITY and most < BACKLOG:
        yield warning(
            "open files",
            f"a process can have {most}: more clients at a time are rejected.",
            f"Raise the limit (ulimit -n {8 * BACKLOG}, or LimitNOFILE of the service).",
        )
    else:
        yield ok("open files", "enough for many clients.")


def _file_size(settings: Settings) -> Iterator[Finding]:
    most = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    if most != resource.RLIM_INFINITY and most < settings.max_upload_bytes:
        yield error(
            "file size",
            f"a file can have {most} bytes: uploads of larger meshes fail.",
            "Raise the limit (ulimit -f unlimited).",
        )


def _memory(settings: Settings) -> Iterator[Finding]:
    needed, total = _BASE_BYTES + _BYTES_PER_FACE * settings.max_faces, memory_bytes()
    available = min(total, settings.job_memory_bytes)
    if available < needed:
        yield warning(
            "memory",
            f"a job can use {available / 2**30:.1f} GiB, and {settings.max_faces} faces need {needed / 2**30:.1f} GiB.",
            f"Lower CLEAVE_MAX_FACES to {max(1, (available - _BASE_BYTES) // _BYTES_PER_FACE)}, or add memory.",
        )
    else:
        yield ok("memory", f"enough for one job of {settings.max_faces} faces at a time.")
    if settings.job_memory_bytes > total:
        yield warning(
            "memory of a job",
            f"a job can use {settings.job_memory_bytes / 2**30:.1f} GiB of {total / 2**30:.1f} GiB: one file can "
            "make the kernel kill other processes.",
            "Lower CLEAVE_JOB_MEMORY_BYTES.",
        )


def memory_bytes() -> int:
    """Return the memory of this machine, or of the container if it has less."""
    limits = [os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")]
    for path in _CGROUP_LIMITS:
        with suppress(OSError, ValueError):
            limits.append(int(Path(path).read_text()))
    return min(limits)


def _kernels() -> Iterator[Finding]:
    compiled, folder = compiled_kernels()
    if compiled:
        yield ok("kernels", f"{compiled} are compiled, in {folder}.")
    else:
        yield warning(
            "kernels",
            "none is compiled: the first job waits up to half a minute.",
            "Start the service once, or run python -m segcore.kernels",
        )


def _access(settings: Settings, host: str) -> Iterator[Finding]:
    try:
        check_exposure(settings, host)
    except InvalidSettings as problem:
        yield error("access", f"the service does not start on {host}.", str(problem))
        return
    if settings.auth == "off" and not host.startswith("127.") and host != "::1":
        yield warning(
            "access",
            f"everyone who can reach {host} can use the service: CLEAVE_AUTH is off.",
            "Make API keys with `cleave key NAME`, unless access is restricted by other means.",
        )
    else:
        yield ok("access", f"on {host} the service accepts only those that it should.")


def _extras() -> Finding:
    try:
        missing = missing_extras()
    except PackageNotFoundError:
        return ok("extras", "not known: the packages are used from a checkout that is not installed.")
    if not missing:
        return ok("extras", "all are installed.")
    return ok("extras", f"not installed: {', '.join(missing)}; to add them: {extra_command(','.join(missing))}.")


def _unknown_variables() -> Iterator[Finding]:
    for name, nearest in unknown_variables(os.environ).items():
        remedy = f"The nearest one is {nearest}" if nearest else "Find its correct name"
        yield warning("settings", f"{name} is not a setting.", f"{remedy}; `cleave serve --help` lists all.")


def _installed() -> str:
    return ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
