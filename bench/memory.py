"""The peak memory of a process."""

from __future__ import annotations

import resource
import sys
from pathlib import Path


def reset_peak(process: int | str = "self") -> int:
    """Reset the peak memory of a process to its present memory, if the system supports that; return it in bytes."""
    try:
        Path(f"/proc/{process}/clear_refs").write_text("5", encoding="ascii")
    except OSError:
        return peak_memory(process)
    return peak_memory(process)


def peak_memory(process: int | str = "self") -> int:
    """Return the peak memory of a process, which must be this one if there is no /proc, in bytes."""
    try:
        lines = Path(f"/proc/{process}/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM:"))
