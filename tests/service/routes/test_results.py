"""Labels, the hierarchy and the list of parts of a job."""

from collections.abc import Callable

import httpx
import pytest

import segcore
from helpers.api import FACES, UNKNOWN, problem, submit
from segcore.io.result import read_result
from segcore.part_list.document import part_list_document
from service.answer.part_list import PartsDocument
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


def test_the_list_of_parts_is_that_of_the_labels_at_every_level(
    client: httpx.Client, store: JobStore, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    with store.results.open(path.rpartition("/")[2]) as file:
        result = read_result(file)
    for query, segments in (({"segments": 3}, 3), ({"granularity": 0}, 1), ({"splits": "0"}, 2)):
        document = client.get(f"{path}/parts", params=query).json()
        listed = segcore.parts(result.mesh, result.hierarchy.labels(segments))
        assert document == part_list_document(listed)
        PartsDocument.model_validate(document, strict=True, extra="forbid")
    assert sum(part["faces"] for part in document["parts"]) == FACES


def test_the_list_of_parts_of_a_revision_has_its_names_and_colours(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    operations = [{"op": "name", "part": 1, "name": "nose"}, {"op": "color", "part": 1, "color": "#112233"}]
    edit = {"base": 0, "level": {"segments": 2}, "operations": operations}
    assert client.post(f"{path}/edits", json=edit).status_code == 201
    for revision in ("1", "latest"):
        answer = client.get(f"{path}/parts", params={"revision": revision})
        assert [(part["name"], part["color"]) for part in answer.json()["parts"]][1] == ("nose", "#112233")
        assert ("immutable" in answer.headers["Cache-Control"]) == (revision == "1")
    assert client.get(f"{path}/parts", params={"segments": 2}).json()["parts"][1]["name"] == ""


@pytest.mark.parametrize("tolerance", ["0", "-1", "0.2", "nan", "x"])
def test_a_tolerance_outside_its_range_is_refused(
    client: httpx.Client, finished_job: Callable[..., str], tolerance: str
) -> None:
    path = finished_job()
    problem(client.get(f"{path}/parts", params={"tolerance": tolerance}), 422, "invalid_request")


@pytest.mark.parametrize("result", ["labels", "hierarchy", "parts", "model.glb"])
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
