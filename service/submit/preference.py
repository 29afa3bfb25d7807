"""The Prefer header (RFC 7240)."""

import re
from dataclasses import dataclass

_WAIT = re.compile(r"wait\s*=\s*\"?(\d{1,9})\"?", re.ASCII | re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Preference:
    """The preference of a client: to wait for the end of the job, or not."""

    wait_s: float
    applied: str | None  # the value of Preference-Applied


def read_preference(prefer: str | None, max_wait_s: float) -> Preference:
    """Return the preference in a Prefer header; without one, the client does not wait."""
    waits = [match for part in (prefer or "").split(",") if (match := _WAIT.fullmatch(part.strip()))]
    if waits:
        wait_s = min(float(waits[0][1]), max_wait_s)
        return Preference(wait_s, f"wait={wait_s:.0f}")
    is_async = any(part.strip().lower() == "respond-async" for part in (prefer or "").split(","))
    return Preference(0.0, "respond-async" if is_async else None)
