"""Labels and the hierarchy of a job."""

from collections.abc import Callable

import httpx
import pytest

from helpers.api import FACES, UNKNOWN, problem, submit
from segcore.io.result import read_result
from worker.jobs.store.store import JobStore


def test_labels_are_those_of_the_stored_hierarchy_at_every_number_of_segments(
    client: httpx.Client, store: JobStore, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    with store.results.open(path.rpartition("/")[2]) as file:
        hierarchy = read_result(file).hierarchy
    for segments in (1, 2, hierarchy.max_segments):
        document = client.get(f"{path}/labels", params={"segments": segments}).json()
        assert document == {"segments": segments, "labels": hierarchy.labels(segments).tolist()}
    automatic = client.get(f"{path}/labels").json()
    assert automatic == {"segments": hierarchy.automatic_segments, "labels": hierarchy.labels().tolist()}
    assert len(automatic["labels"]) == FACES


def test_the_hierarchy_is_the_whole_tree(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    document = client.get(f"{path}/hierarchy").json()
    assert len(document["nodes"]) == 2 * document["max_segments"] - 1
    assert document["nodes"][0]["faces"] == FACES
    job = client.get(path).json()
    assert document["max_segments"] == job["max_segments"]
    assert document["limit_reached"] is job["limit_reached"] is False


def test_the_n_ary_tree_starts_at_the_root_and_has_every_leaf(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    document = client.get(f"{finished_job()}/hierarchy").json()
    nodes = document["nodes"]
    leaves, waiting = [], [0]
    while waiting:
        node = nodes[waiting.pop()]
        waiting += node["nary_children"]
        leaves += [] if node["nary_children"] else [node["id"]]
    assert sorted(leaves) == [node["id"] for node in nodes if not node["children"]]
    assert document["step_ends"][-1] == document["max_segments"]


def test_the_curve_has_a_point_for_every_cut(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    document = client.get(f"{finished_job()}/hierarchy").json()
    assert [point["segments"] for point in document["curve"]] == list(range(2, document["max_segments"] + 1))
    assert [point["cut_value"] for point in document["curve"]] == document["cut_values"]
    for point in document["curve"]:
        assert document["nodes"][point["node"]]["cut_value"] == point["cut_value"]
        assert document["nodes"][point["node"]]["step"] == point["step"]
    assert [point["step"] for point in document["curve"]] == document["steps"]


@pytest.mark.parametrize("result", ["labels", "hierarchy", "model.glb"])
def test_results_of_a_job_without_one_are_a_conflict(
    client: httpx.Client, finished_job: Callable[..., str], result: str
) -> None:
    answer = client.get(f"{submit(client)}/{result}")
    problem(answer, 409, "not_finished")
    assert int(answer.headers["Retry-After"]) > 0
    failed = problem(client.get(f"{finished_job(b'PK' + bytes([3, 4]))}/{result}"), 409, "job_failed")
    assert failed["error"]["code"] == "unsupported_format"  # type: ignore[index]
    canceled = submit(client)
    client.post(f"{canceled}/cancel")
    problem(client.get(f"{canceled}/{result}"), 409, "job_canceled")
    problem(client.get(f"{UNKNOWN}/{result}"), 404, "job_not_found")


@pytest.mark.parametrize("segments", ["0", "-1", "100000", "x", "1.5", "", "9" * 5000, "NaN", "%ED%A0%80"])
def test_an_invalid_number_of_segments_is_refused(
    client: httpx.Client, finished_job: Callable[..., str], segments: str
) -> None:
    answer = client.get(f"{finished_job()}/labels?segments={segments}")
    body = problem(answer, 422, "invalid_parameters" if segments == "100000" else "invalid_request")
    if segments == "100000":
        assert "from 1 to" in str(body["detail"])
