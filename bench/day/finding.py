"""A line of the table of the day."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """A number that was counted in the evening."""

    name: str
    count: int
    must_be_zero: bool = True

    @property
    def is_wrong(self) -> bool:
        return self.must_be_zero and self.count > 0


def render(findings: Sequence[Finding]) -> str:
    """Return the findings as a Markdown table."""
    rows = [f"| {finding.name} | {finding.count}{' (must be 0)' * finding.is_wrong} |" for finding in findings]
    return "\n".join(["| | |", "|---|---|", *rows])
