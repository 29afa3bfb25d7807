"""The documents of the API agree with the lists of formats and stages that they are made from."""

import httpx

from cleave.settings import Settings
from helpers.api import submit
from service.answer.model_formats import MODELS, model_links
from service.job_documents import JobLinks
from worker.jobs.store.store import JobStore
from worker.process.perform import perform
from worker.process.progress import REPORTED_STAGES, STAGES


def test_every_model_has_a_link_to_a_route(client: httpx.Client) -> None:
    links = model_links("/v1/jobs/{job_id}")
    assert len(links) == len(MODELS)
    assert set(links) < set(JobLinks.model_fields)
    assert set(links.values()) < set(client.get("/openapi.json").json()["paths"])


def test_a_job_runs_through_all_stages_in_their_order(
    client: httpx.Client, store: JobStore, settings: Settings
) -> None:
    job_id = submit(client).rpartition("/")[2]
    reported: dict[str, float] = {}
    work = perform(store, settings, job_id, reported.__setitem__)
    assert work is not None
    assert tuple(reported) == REPORTED_STAGES
    assert tuple(work.stage_seconds) == STAGES
