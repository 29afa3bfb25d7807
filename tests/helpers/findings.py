"""Findings of the checks of `cleave doctor`."""

from service.doctor.findings import Finding


def severities(findings: list[Finding]) -> dict[str, str]:
    """Return the worst severity of each topic. Every finding must be a sentence, with a fix unless it is ok."""
    assert all((finding.fix is None) == (finding.severity == "ok") for finding in findings)
    assert all(finding.message.endswith(".") for finding in findings)
    order = ["ok", "warning", "error"]
    worst: dict[str, str] = {}
    for finding in findings:
        worst[finding.topic] = max(finding.severity, worst.get(finding.topic, "ok"), key=order.index)
    return worst
