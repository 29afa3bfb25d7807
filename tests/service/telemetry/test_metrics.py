"""Metrics of the requests of one service, and of its queue."""

import httpx

from helpers.api import samples, submit
from helpers.jobs import SMALL
from worker.jobs.queue.queue import JobQueue


def test_requests_are_counted_by_route_and_jobs_by_queue(client: httpx.Client, queue: JobQueue) -> None:
    path = submit(client)
    for _ in range(3):
        client.get(path)
    client.get("/nowhere")
    found = samples(client)
    assert found['cleave_requests_total{method="GET",route="/v1/jobs/{job_id}",status="200"}'] == 3
    assert found['cleave_requests_total{method="any",route="none",status="404"}'] == 1
    assert found['cleave_jobs_submitted_total{result="accepted"}'] == 1
    assert found["cleave_unfinished_jobs"] == found['cleave_waiting_jobs{queue="small"}'] == 1
    assert found['cleave_waiting_jobs{queue="large"}'] == 0
    assert found["cleave_oldest_unfinished_seconds"] > 0
    queue.entries[SMALL].pop_job_id()
    assert samples(client)['cleave_waiting_jobs{queue="small"}'] == 0


def test_metrics_are_served_while_the_queue_is_down(client_without_queue: httpx.Client) -> None:
    found = samples(client_without_queue)
    assert found["cleave_queue_up"] == 0
    assert 'cleave_waiting_jobs{queue="small"}' not in found
    assert "cleave_faces_total" not in found  # a 0 would look like an increase when the queue is back
