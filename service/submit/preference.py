"""What a Prefer header asks for (RFC 7240)."""

import re
from dataclasses import dataclass

_WAIT = re.compile(r"wait\s*=\s*\"?(\d{1,9})\"?", re.ASCII | re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Preference:
    """What a Prefer header asks for (RFC 7240)."""

    wait_s: float
    applied: str | None  # to be told


def read_preference(prefer: str | None, most_s: float) -> Preference:
    waits = [match for part in (prefer or "").split(",") if (match := _WAIT.fullmatch(part.strip()))]
    if waits:
        wait_s = min(float(waits[0][1]), most_s)
        return Preference(wait_s, f"wait={wait_s:.0f}")
    is_async = any(part.strip().lower() == "respond-async" for part in (prefer or "").split(","))
    return Preference(0.0, "respond-async" if is_async else None)
