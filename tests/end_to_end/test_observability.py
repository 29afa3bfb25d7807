"""A job in the logs of all processes that handled it, and in the metrics."""

import json
import os
import re
import signal

import httpx

from helpers.installation import Installation, LoggingInstallation
from helpers.jobs import LONG, sphere
from helpers.waiting import wait_until

TRACE_ID = "4bf92f3577b34da6a3ce929d0e0e4736"
PARENT = f"00-{TRACE_ID}-00f067aa0ba902b7-01"


def test_the_log_lines_of_a_job_have_its_id_and_trace_in_every_process() -> None:
    with LoggingInstallation() as installation:
        answer = httpx.post(
            f"{installation.url}/v1/jobs",
            files={"mesh": ("mesh.off", sphere(100))},
            data={"parameters": json.dumps(LONG)},
            headers={"traceparent": PARENT},
            timeout=60,
        )
        job_id, path = answer.json()["id"], answer.headers["Location"]
        assert answer.headers["traceparent"].split("-")[1] == TRACE_ID
        wait_until(installation.horses)
        (horse,) = installation.horses()
        for worker in installation.children("worker.process"):
            os.kill(worker, signal.SIGKILL)
        with installation.redis() as connection:
            connection.delete(f"cleave:lease:{job_id}")
        wait_until(lambda: installation.status(path) == "succeeded", within_s=120)
        wait_until(
            lambda: "succeeded" in {line["message"] for line in installation.lines() if line["process"] == "work_horse"}
        )
        lines = [line for line in installation.lines() if line.get("method") != "GET"]  # those of this test itself
        about = [line for line in lines if line.get("job_id") == job_id]
        assert {line["process"] for line in about} == {"service", "worker", "work_horse", "janitor"}
        assert {line["trace_id"] for line in about} == {TRACE_ID}
        assert all(line["job_id"] == job_id for line in lines if job_id in line["message"])
        assert horse not in {line["pid"] for line in about if line["message"] == "succeeded"}
        check_metrics(installation)


class TerseInstallation(LoggingInstallation):
    settings = LoggingInstallation.settings | {"CLEAVE_LOG_LEVEL": "info"}  # the default


def test_a_job_has_one_line_in_the_log_by_default() -> None:
    with TerseInstallation() as installation:
        path = installation.submit(sphere(12))
        wait_until(lambda: installation.status(path) == "succeeded")
        failed = installation.submit(b"not a mesh")
        wait_until(lambda: installation.status(failed) == "failed")
        wait_until(lambda: any(line["message"] == "failed" for line in installation.lines()))
        lines = installation.lines()
    (done,) = (line for line in lines if path.endswith(line.get("job_id", "none")))
    assert (done["message"], done["faces"], done["owner"]) == ("succeeded", 4 * 12 * 11, None)
    stages = done["stage_seconds"]
    assert 0 < sum(stages.values()) - stages["storing"] < done["seconds"]  # the end is noted before it is stored
    (refused,) = (line for line in lines if failed.endswith(line.get("job_id", "none")))
    assert (refused["message"], refused["code"]) == ("failed", "invalid_mesh")


def check_metrics(installation: Installation) -> None:
    metrics = installation.get("/metrics").text
    found = dict(re.findall(r"^(\w+(?:{.*})?) ([\d.e+-]+)$", metrics, re.MULTILINE))
    assert found['cleave_jobs_finished_total{code="",status="succeeded"}'] == "1.0"
    assert found["cleave_faces_total"] == str(float(4 * 100 * 99))
    assert found["cleave_recovered_jobs_total"] == "1.0"
    stages = set(re.findall(r'cleave_stage_seconds_count{stage="(\w+)"}', metrics))
    assert stages >= {"reading", "affinity", "coarsen", "cut", "label", "storing"}
