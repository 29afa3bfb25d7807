"""The documents of the API agree with the lists of formats and stages that they are made from."""

import httpx

from cleave.settings import Settings
from helpers.api import submit
from service.answer.model_formats import MODELS, model_links
from service.job_documents import JobLinks, job_document
from worker.jobs.job import Succeeded, now
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


def test_a_job_says_what_to_do_if_its_automatic_number_is_one(client: httpx.Client, store: JobStore) -> None:
    job = store.records.job(submit(client).rpartition("/")[2])
    assert job is not None
    for automatic, most, count in ((1, 9, 1), (1, 1, 0), (2, 9, 0)):
        done = Succeeded(finished_at=now(), faces=9, vertices=9, max_segments=most, automatic_segments=automatic)
        notes = job_document(job, done, [], None).notes
        assert len(notes) == count
        assert all("from 2 to 9" in note for note in notes)
