"""Metrics of the requests of one service, and of its queue."""

import httpx

from cleave.version import installed_version
from helpers.api import samples, submit
from helpers.jobs import SMALL
from worker.jobs.queue.counters import JobCounters, Stored
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


def test_the_operator_sees_the_version_the_process_and_the_disk(client: httpx.Client) -> None:
    submit(client)
    found = samples(client)
    (build,) = (name for name in found if name.startswith("cleave_build_info{"))
    assert f'version="{installed_version()}"' in build
    assert found["process_resident_memory_bytes"] > 0
    assert 0 < found["cleave_disk_free_bytes"] <= found["cleave_disk_bytes"]
    assert not [name for name in found if "_created" in name]


def test_the_size_of_the_store_is_that_which_the_janitor_has_noted(client: httpx.Client, queue: JobQueue) -> None:
    assert "cleave_stored_bytes" not in samples(client)
    JobCounters(queue.connection).jobs_counted(Stored(7, 1234))
    found = samples(client)
    assert (found["cleave_stored_jobs"], found["cleave_stored_bytes"]) == (7, 1234)
