"""The table of the day, its messages, and its exit status."""

import base64
import json
from datetime import UTC, datetime
from typing import Any

import pytest

from bench.__main__ import main
from bench.commands import day as command
from bench.day.finding import Finding, render
from bench.day.member import Accepted
from bench.day.messages import told
from bench.day.orders import Order, Orders
from bench.day.receiver import Message
from worker.webhooks.message import SECRET_PREFIX, signature

NOON = int(datetime(2026, 1, 1, 12, tzinfo=UTC).timestamp())


class Member:
    """A client that needs no service."""

    def __init__(self, name: str, *jobs: Accepted) -> None:
        self.name, self.jobs, self.http = name, list(jobs), self

    def get(self, _: str) -> "Member":
        return self

    def json(self) -> dict[str, str]:
        return {"secret": SECRET_PREFIX + base64.b64encode(self.name.encode()).decode()}


def job(job_id: str, **changes: Any) -> Accepted:
    return Accepted(job_id, Order(b""), None, "", **changes)


def message(job_id: str, to: str, status: str = "succeeded", signed_for: str = "", is_accepted: bool = True) -> Message:
    body = json.dumps({"data": {"id": job_id, "status": status}}).encode()
    signed = signature((signed_for or to).encode(), f"msg_{job_id}", NOON, body)
    headers = {"webhook-id": f"msg_{job_id}", "webhook-timestamp": str(NOON), "webhook-signature": signed}
    return Message(f"/{to}", headers, body, is_accepted)


def wrong(*messages: Message) -> set[str]:
    """The findings of two clients, the second of which has a canceled job and one that it deleted."""
    members = [
        Member("anna", job("a")),
        Member("ben", job("b", ends="canceled"), job("c", deleted_at=datetime.now(UTC))),
    ]
    return {finding.name for finding in told(members, messages) if finding.is_wrong}  # type: ignore[arg-type]


def test_a_message_for_each_end_to_its_client_is_right() -> None:
    a, b = message("a", "anna"), message("b", "ben", "canceled")
    refused = message("a", "anna", is_accepted=False)
    assert wrong(a, b) == wrong(refused, a, b) == wrong(a, b, message("c", "ben", "canceled")) == set()


@pytest.mark.parametrize(
    ("more", "name"),
    [
        ([], "ends of jobs that were not told"),
        ([message("b", "ben", "canceled", is_accepted=False)], "ends of jobs that were not told"),
        ([message("b", "ben", "canceled")] * 2, "ends of jobs that were told twice"),
        ([message("b", "ben", "succeeded")], "messages of another end, or to another client"),
        ([message("b", "anna", "canceled")], "messages of another end, or to another client"),
        ([message("b", "ben", "canceled", signed_for="anna")], "messages with another signature"),
    ],
)
def test_every_other_message_is_wrong(more: list[Message], name: str) -> None:
    assert wrong(message("a", "anna"), *more) == {name}


def test_orders_of_different_clients_are_different() -> None:
    first, second = Orders(0, 2, 2_000), Orders(1, 2, 2_000)
    orders = [first.short(), first.long(), second.short(), second.long()]
    assert len({order.mesh for order in orders}) == len(orders)
    assert "clusters" in orders[1].query["parameters"]


@pytest.mark.parametrize(("lost", "status"), [(0, 0), (1, 1)])
def test_the_exit_status_is_1_if_anything_is_wrong(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], lost: int, status: int
) -> None:
    findings = [Finding("jobs", 7, must_be_zero=False), Finding("lost", lost)]
    monkeypatch.setattr(command, "day", lambda plan: findings if plan.previous == "abc" else [])
    assert main(["day", "--from", "abc"]) == status
    assert capsys.readouterr().out == render(findings) + "\n"
    assert ("| lost | 1 (must be 0) |" in render(findings)) == bool(lost)
