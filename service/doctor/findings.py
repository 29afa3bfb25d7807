"""The findings of the checks, as text and as JSON."""

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Literal, TypeAlias

Severity: TypeAlias = Literal["ok", "warning", "error"]


@dataclass(frozen=True, slots=True)
class Finding:
    """The result of one check."""

    topic: str  # what was checked
    severity: Severity  # error: the installation does not work as documented, or will soon fail to
    message: str
    fix: str | None = None  # what to do; None if nothing has to be done


def ok(topic: str, message: str) -> Finding:
    return Finding(topic, "ok", message)


def warning(topic: str, message: str, fix: str) -> Finding:
    return Finding(topic, "warning", message, fix)


def error(topic: str, message: str, fix: str) -> Finding:
    return Finding(topic, "error", message, fix)


def has_errors(findings: Iterable[Finding]) -> bool:
    return any(finding.severity == "error" for finding in findings)


def as_json(findings: list[Finding]) -> str:
    document = {"healthy": not has_errors(findings), "findings": [asdict(finding) for finding in findings]}
    return json.dumps(document, indent=2)


def as_text(findings: list[Finding]) -> str:
    """Return a line for each finding, followed by its fix if there is one, and a line with the totals."""
    lines = []
    for finding in findings:
        lines.append(f"{finding.severity:<8} {finding.topic}: {finding.message}")
        if finding.fix is not None:
            lines.append(f"{'':<8} -> {finding.fix}")
    errors = sum(finding.severity == "error" for finding in findings)
    warnings = sum(finding.severity == "warning" for finding in findings)
    return "\n".join([*lines, f"{errors} errors, {warnings} warnings"])
