"""Server-sent events: every change once, increasing ids, and an end."""

import json
import threading
from collections.abc import Callable

import httpx

from helpers.api import UNKNOWN, problem, submit
from worker.jobs.queue.queue import JobQueue, Progress


def events(client: httpx.Client, path: str, **headers: str) -> list[tuple[int, dict[str, object]]]:
    """Return all events of a job until the stream ends, with their ids."""
    with client.stream("GET", f"{path}/events", headers=headers) as answer:
        assert answer.status_code == 200
        assert answer.headers["Content-Type"].startswith("text/event-stream")
        blocks = "".join(answer.iter_text()).split("\n\n")
    found = []
    for block in blocks:
        fields = dict(line.split(": ", 1) for line in block.splitlines() if ": " in line)
        if fields.get("event") == "status":
            found.append((int(fields["id"]), json.loads(fields["data"])))
    return found


def test_events_follow_a_job_from_the_queue_to_its_end(client: httpx.Client, queue: JobQueue) -> None:
    path = submit(client)
    job_id = path.rpartition("/")[2]
    seen: list[tuple[int, dict[str, object]]] = []
    reader = threading.Thread(target=lambda: seen.extend(events(client, path)))
    reader.start()
    queue.take(job_id, "worker", lease_s=30)
    for stage, fraction in (("clean", 0.1), ("cut", 0.7)):
        queue.publish(job_id, Progress(stage, fraction))
        reader.join(0.5)
    client.post(f"{path}/cancel")
    reader.join(30)
    assert not reader.is_alive()
    ids = [number for number, _ in seen]
    assert ids == sorted(set(ids))
    assert [job["stage"] for _, job in seen if job["stage"]] == ["clean", "cut"]
    assert seen[-1][1] == client.get(path).json()
    assert seen[-1][1]["status"] == "canceled"


def test_a_client_that_received_the_last_event_does_not_reconnect(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    ((number, job),) = events(client, path)
    assert job["status"] == "succeeded"
    assert client.get(f"{path}/events", headers={"Last-Event-ID": str(number)}).status_code == 204
    ((again, same),) = events(client, path, **{"Last-Event-ID": "1"})
    assert same == job
    assert again > 1


def test_only_a_job_has_events(client: httpx.Client) -> None:
    problem(client.get(f"{UNKNOWN}/events"), 404, "job_not_found")
    problem(client.get(f"{submit(client)}/events", headers={"Last-Event-ID": "x"}), 422, "invalid_request")
