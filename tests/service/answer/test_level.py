"""Results at a granularity or a set of splits, instead of a number of segments."""

from collections.abc import Callable

import httpx
import numpy as np
import pytest

from helpers.api import problem
from segcore.io.result import read_result
from worker.jobs.store.store import JobStore

FORMS = ("labels", "model.glb", "model.ply", "model.obj", "model.3mf", "parts.zip", "preview.png")


@pytest.fixture
def job(finished_job: Callable[..., str]) -> str:
    return finished_job()


def test_the_first_splits_give_the_level(client: httpx.Client, job: str) -> None:
    for segments in (1, 2, 5):
        splits = ",".join(map(str, range(segments - 1)))
        by_hand = client.get(f"{job}/labels", params={"splits": splits})
        assert by_hand.json() == client.get(f"{job}/labels", params={"segments": segments}).json()


def test_splits_that_are_no_level_separate_faces_like_the_hierarchy(
    client: httpx.Client, job: str, store: JobStore
) -> None:
    with store.results.open(job.rpartition("/")[2]) as file:
        hierarchy = read_result(file).hierarchy
    last = next(s for s in range(2, hierarchy.max_segments - 1) if hierarchy.split_node[s] in (1, 2))
    document = client.get(f"{job}/labels", params={"splits": f"{last},0"}).json()
    assert document["segments"] == 3
    cut_node = int(hierarchy.split_node[last])
    below = hierarchy.labels(last + 2)
    above = hierarchy.labels(2)
    inside = above == int(hierarchy.label[cut_node])
    labels = np.array(document["labels"])
    assert len(set(labels[inside])) == 2
    assert len(set(labels[~inside])) == 1
    own = int(hierarchy.label[2 * last + 2])
    assert len(set(labels[inside & (below == own)])) == 1
    assert not set(labels[inside & (below == own)]) & set(labels[inside & (below != own)])


@pytest.mark.parametrize("form", FORMS)
def test_every_result_accepts_splits(client: httpx.Client, job: str, form: str) -> None:
    answer = client.get(f"{job}/{form}", params={"splits": "0"})
    assert answer.status_code == 200
    assert answer.content
    assert answer.headers["ETag"] != client.get(f"{job}/{form}", params={"splits": ""}).headers["ETag"]


@pytest.mark.parametrize("splits", ["1", "0,9999", "99999"])
def test_splits_that_do_not_exist_are_refused(client: httpx.Client, job: str, splits: str) -> None:
    problem(client.get(f"{job}/labels", params={"splits": splits}), 422, "invalid_parameters")


@pytest.mark.parametrize("others", [{"splits": "0", "segments": 2}, {"splits": "0", "granularity": 1}])
def test_splits_and_a_level_together_are_refused(client: httpx.Client, job: str, others: dict[str, str]) -> None:
    body = problem(client.get(f"{job}/labels", params=others), 422, "invalid_parameters")
    assert "one of segments, granularity and splits" in str(body["detail"])


@pytest.mark.parametrize("granularity", [0, 0.3, 0.5, 0.7, 1])
def test_a_granularity_selects_the_number_of_segments_of_the_hierarchy(
    client: httpx.Client, job: str, store: JobStore, granularity: float
) -> None:
    with store.results.open(job.rpartition("/")[2]) as file:
        segments = read_result(file).hierarchy.segments_at(granularity)
    for form in FORMS:
        answer = client.get(f"{job}/{form}", params={"granularity": granularity})
        assert answer.status_code == 200
        assert answer.headers["ETag"] == client.get(f"{job}/{form}", params={"segments": segments}).headers["ETag"]
    assert client.get(f"{job}/labels", params={"granularity": granularity}).json()["segments"] == segments


def test_a_granularity_and_a_number_together_are_refused(client: httpx.Client, job: str) -> None:
    both = {"granularity": 0.7, "segments": 2}
    for answer in (client.get(f"{job}/labels", params=both), client.post("/v1/jobs", params=both, content=b"OFF")):
        assert "either segments or granularity" in str(problem(answer, 422, "invalid_parameters")["detail"])


@pytest.mark.parametrize("granularity", ["-0.1", "1.1", "nan", "fine"])
def test_a_granularity_outside_of_its_range_is_refused(client: httpx.Client, job: str, granularity: str) -> None:
    problem(client.get(f"{job}/labels", params={"granularity": granularity}), 422, "invalid_request")


def test_malformed_splits_are_refused(client: httpx.Client, job: str) -> None:
    problem(client.get(f"{job}/labels", params={"splits": "0;1"}), 422, "invalid_request")
