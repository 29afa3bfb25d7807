"""A client of the team with a key of its own: what it sends, and what it may expect of each job."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import count
from typing import Any

import httpx

from bench.day.orders import Order, Orders
from bench.day.proxies import Proxy
from bench.errors import BenchmarkError
from bench.load.retries import until_answered
from worker.jobs.job import now

ENDED = ("succeeded", "failed", "canceled")
_POLL_S = 10
_ENDS_WITHIN_S = 240.0
_ACCEPTED = (200, 202)


@dataclass(slots=True, eq=False)
class Accepted:
    """A job that was accepted."""

    id: str
    order: Order
    key: str | None  # the Idempotency-Key of its request
    location: str
    ends: str = "succeeded"  # the status that it must have in the end
    deleted_at: datetime | None = None

    @property
    def is_deleted(self) -> bool:
        return self.deleted_at is not None


class Member:
    """One client, which repeats requests while the service is away."""

    def __init__(self, name: str, key: str, proxy: Proxy, webhook: str, orders: Orders) -> None:
        self.name = name
        self.orders = orders
        self.jobs: list[Accepted] = []
        self.batches: list[str] = []
        self.repeats: list[tuple[str, str]] = []  # the id of a job, and that in the answer to the repeated request
        self._webhook = webhook
        self._keys = count()
        self.proxy = proxy
        self.http = self.client({"Authorization": f"Bearer {key}"})

    def client(self, headers: dict[str, str]) -> httpx.Client:
        """Return a client for the service that sends some headers with every request."""
        return httpx.Client(base_url=self.proxy.url, headers=headers, timeout=60, verify=self.proxy.trust)

    def submit(self, order: Order) -> Accepted:
        """Submit a job with an Idempotency-Key, so that a repeated request makes no second job."""
        key = f"{self.name}-{next(self._keys)}"
        answer = self._post(order, key)
        return self._accepted(answer.json()["id"], order, key, answer.headers["Location"])

    def repeat(self, job: Accepted) -> None:
        """Send the request of a job again, as a client does that has not seen the answer."""
        assert job.key is not None
        self.repeats.append((job.id, self._post(job.order, job.key).json()["id"]))

    def submit_batch(self, orders: Sequence[Order]) -> list[Accepted]:
        """Submit several meshes in one request."""
        files = [("mesh", (f"{number}.ply", order.mesh)) for number, order in enumerate(orders)]
        query = {"webhook": self._webhook}
        document = self._batch(lambda: self.http.post("/v1/batches", files=files, params=query))
        return [
            self._accepted(job["id"], order, None, job["self"])
            for job, order in zip(document["jobs"], orders, strict=True)
        ]

    def combine(self, jobs: Sequence[Accepted]) -> None:
        """Make a batch of jobs that exist."""
        ids = [job.id for job in jobs]
        self._batch(lambda: self.http.post("/v1/batches", json={"jobs": ids}))

    def cancel(self, job: Accepted) -> None:
        """Cancel a job, which may have ended a moment before."""
        answer = until_answered(lambda: self.http.post(f"/v1/jobs/{job.id}/cancel"), (200, 409))
        job.ends = "canceled" if answer.status_code == 200 else "succeeded"

    def delete(self, job: Accepted) -> None:
        until_answered(lambda: self.http.delete(f"/v1/jobs/{job.id}"), (204, 410))  # 410: it was deleted before
        job.deleted_at = now()

    def wait(self, job: Accepted) -> Accepted:
        """Wait until a job has ended.

        Raises
        ------
        BenchmarkError
            If it does not end in time.
        """
        deadline = time.monotonic() + _ENDS_WITHIN_S
        while self.document(job, wait_s=_POLL_S)["status"] not in ENDED:
            if time.monotonic() > deadline:
                raise BenchmarkError(f"Job {job.id} has not ended after {_ENDS_WITHIN_S:.0f} s.")
        return job

    def document(self, job: Accepted, wait_s: int = 0) -> dict[str, Any]:
        """Return the document of a job, after so many seconds if the job has not ended before."""
        answer = until_answered(lambda: self.http.get(f"/v1/jobs/{job.id}", params={"wait": wait_s}), (200,))
        document: dict[str, Any] = answer.json()
        return document

    def listed(self) -> dict[str, str]:
        """Return the status of every job that the service shows to this client, by id."""
        found: dict[str, str] = {}
        query: dict[str, str | int] = {"limit": 20}
        while True:
            page = until_answered(lambda: self.http.get("/v1/jobs", params=query), (200,)).json()
            found |= {job["id"]: job["status"] for job in page["jobs"]}
            if page["next_cursor"] is None:
                return found
            query["cursor"] = page["next_cursor"]

    def _post(self, order: Order, key: str) -> httpx.Response:
        headers = {"Content-Type": "model/ply", "Idempotency-Key": key}
        query = order.query | {"webhook": self._webhook}
        return until_answered(
            lambda: self.http.post("/v1/jobs", content=order.mesh, headers=headers, params=query), _ACCEPTED
        )

    def _batch(self, send: Callable[[], httpx.Response]) -> dict[str, Any]:
        document: dict[str, Any] = until_answered(send, _ACCEPTED).json()
        self.batches.append(document["id"])
        return document

    def _accepted(self, job_id: str, order: Order, key: str | None, location: str) -> Accepted:
        job = Accepted(job_id, order, key, location)
        self.jobs.append(job)
        return job
