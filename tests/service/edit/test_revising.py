"""Edits through the API: the revisions that they make, and every result with their parts."""

import io
import json
import struct
import threading
from collections.abc import Callable
from typing import Any

import httpx
import numpy as np
import pygltflib
import pytest
import trimesh

from helpers.api import FACES, problem
from helpers.edits.requests import OTHER_KEY, edit, labels
from segcore.io import read_result
from worker.jobs.store.store import JobStore

MERGE = {"op": "merge", "parts": [0, 2]}


def name(part: int, text: str) -> dict[str, Any]:
    return {"op": "name", "part": part, "name": text}


def test_parts_that_are_no_siblings_are_merged_named_and_found_in_every_file(api: httpx.Client, job: str) -> None:
    before = labels(api, job, segments=6)
    edited = edit(
        api,
        job,
        0,
        {"op": "merge", "parts": [5, 1, 3]},
        {"op": "assign", "faces": {"starts": [0], "lengths": [3]}, "to": "new"},
        name(3, "left arm"),
        {"op": "color", "part": 3, "color": "#102030"},
        {"op": "class", "part": 3, "class": "limb"},
        level={"segments": 6},
    )
    assert edited["segments"] == 5
    after = labels(api, job, revision="latest")
    joined = {frozenset(np.flatnonzero(np.array(after) == part).tolist()) for part in range(5)}
    arm = {face for face, label in enumerate(before) if label in (1, 3, 5)} - {0, 1, 2}
    assert joined >= {frozenset(arm), frozenset({0, 1, 2})}
    assert api.get(job).json()["revision"] == 1
    listed = {one["links"]["self"]: one["revision"] for one in api.get("/v1/jobs").json()["jobs"]}
    assert listed[job] == 1

    glb = api.get(f"{job}/model.glb", params={"revision": 1}).content
    scene = trimesh.load(io.BytesIO(glb), file_type="glb")
    assert {mesh: len(geometry.faces) for mesh, geometry in scene.geometry.items()}["left arm"] == after.count(3)
    model = pygltflib.GLTF2().load_from_bytes(glb)
    material = next(one for one in model.materials if one.name == "left arm")
    assert material.pbrMetallicRoughness.baseColorFactor[0] == pytest.approx(
        ((0x10 / 255 + 0.055) / 1.055) ** 2.4, abs=1e-6
    )
    shown = next(one for one in model.nodes if one.name == "left arm")
    assert shown.extras["segment"] == 3
    (length,) = struct.unpack_from("<I", glb, 12)
    assert json.loads(glb[20 : 20 + length])["scenes"][0]["extras"]["segments"] == 5
    every = "model.3mf model.obj.zip parts.zip parts.zip?format=glb model.ply preview.png model.glb?keep=all"
    for result in (*every.split(), "model.glb?levels=all&features=true", "model.glb?layout=flat"):
        found = api.get(f"{job}/{result}{'&' if '?' in result else '?'}revision=latest")
        assert found.status_code == 200, found.text
    assert b"newmtl left_arm\nKd 0.0627 0.1255 0.1882" in api.get(f"{job}/model.mtl", params={"revision": 1}).content


def test_every_revision_stays_and_each_undo_is_a_new_one(api: httpx.Client, job: str) -> None:
    edit(api, job, 0, MERGE)
    edit(api, job, 1, name(0, "body"))
    restored = edit(api, job, 2, {"op": "restore", "revision": 1})
    assert restored["revision"]["what"] == "restore revision 1"
    assert restored["parts"][0]["name"] == ""
    again = edit(api, job, 3, {"op": "restore", "revision": 0, "level": {"segments": 3}})
    assert again["segments"] == 3
    assert labels(api, job, revision=4) == labels(api, job, segments=3) == labels(api, job, revision="latest")
    assert labels(api, job, revision=1) == labels(api, job, revision=2) == labels(api, job, revision=3)
    assert labels(api, job, revision=0) == labels(api, job)
    found = api.get(f"{job}/revisions", params={"limit": 3}).json()
    assert [(one["number"], one["parent"], one["made_by"]) for one in found["revisions"]] == [
        (4, 3, "anna"),
        (3, 2, "anna"),
        (2, 1, "anna"),
    ]
    assert (found["newest"], found["next"]) == (4, 2)
    rest = api.get(f"{job}/revisions", params={"before": found["next"]}).json()
    assert [(one["number"], one["what"]) for one in rest["revisions"]] == [(1, "merge parts 0, 2")]
    assert rest["next"] is None
    parts = api.get(f"{job}/revisions/2").json()["parts"]
    assert parts[0]["name"] == "body"
    assert sum(part["faces"] for part in parts) == FACES


def test_the_response_has_exactly_the_faces_that_have_changed(api: httpx.Client, job: str) -> None:
    before = np.array(labels(api, job))
    changed = edit(api, job, 0, MERGE)["changed"]
    for first, length, label in zip(changed["starts"], changed["lengths"], changed["labels"], strict=True):
        assert (before[first : first + length] != label).all()
        before[first : first + length] = label
    assert before.tolist() == labels(api, job, revision=1)


def test_a_preview_is_not_stored(api: httpx.Client, job: str) -> None:
    answer = api.post(f"{job}/edits/preview", json={"base": 0, "operations": [MERGE]})
    assert answer.status_code == 200, answer.text
    assert answer.json()["revision"] is None
    assert api.get(f"{job}/revisions").json() == {"newest": 0, "revisions": [], "next": None}
    assert answer.json()["changed"] == edit(api, job, 0, MERGE)["changed"]


def test_of_two_edits_of_a_revision_one_is_stored_and_the_other_learns_of_it(api: httpx.Client, job: str) -> None:
    answers: list[httpx.Response] = []
    together = threading.Barrier(2)

    def send(text: str) -> None:
        together.wait()
        answers.append(api.post(f"{job}/edits", json={"base": 0, "operations": [name(0, text)]}))

    threads = [threading.Thread(target=send, args=(text,)) for text in ("one", "other")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    stored, refused = sorted(answers, key=lambda answer: answer.status_code)
    assert stored.status_code == 201
    newer = problem(refused, 409, "revision_conflict")["revision"]
    assert newer == stored.json()["revision"]
    assert api.get(f"{job}/revisions").json()["newest"] == 1


def test_an_edit_of_an_older_revision_is_refused(api: httpx.Client, job: str) -> None:
    edit(api, job, 0, MERGE)
    edit(api, job, 1, name(0, "body"))
    answer = api.post(f"{job}/edits", json={"base": 1, "operations": [MERGE]})
    assert problem(answer, 409, "revision_conflict")["revision"]["number"] == 2  # type: ignore[index]
    problem(api.post(f"{job}/edits", json={"base": 3, "operations": [MERGE]}), 404, "revision_not_found")


def test_an_edit_that_is_sent_again_makes_one_revision(api: httpx.Client, job: str) -> None:
    headers = {"Idempotency-Key": "a"}
    body = {"base": 0, "operations": [MERGE]}
    first = api.post(f"{job}/edits", json=body, headers=headers)
    edit(api, job, 1, name(0, "body"))
    again = api.post(f"{job}/edits", json=body, headers=headers)
    assert (again.status_code, again.json(), again.headers["Location"]) == (
        201,
        first.json(),
        first.headers["Location"],
    )
    other = {"base": 0, "operations": [name(0, "x")]}
    problem(api.post(f"{job}/edits", json=other, headers=headers), 422, "idempotency_key_reused")
    problem(api.post(f"{job}/edits", json=body, headers={"Idempotency-Key": "b"}), 409, "revision_conflict")
    assert api.get(f"{job}/revisions").json()["newest"] == 2


def test_results_of_a_revision_are_cached_and_those_of_the_newest_are_checked(api: httpx.Client, job: str) -> None:
    url = f"{job}/labels"
    plain = api.get(url)
    newest = api.get(url, params={"revision": "latest"})
    assert newest.headers["ETag"] == plain.headers["ETag"]
    assert newest.headers["Cache-Control"] == "private, no-cache"
    edit(api, job, 0, MERGE)
    one, latest = (api.get(url, params={"revision": revision}) for revision in ("1", "latest"))
    assert one.headers["ETag"] == latest.headers["ETag"] != plain.headers["ETag"]
    assert "immutable" in one.headers["Cache-Control"]
    assert (
        api.get(url, params={"revision": "latest"}, headers={"If-None-Match": one.headers["ETag"]}).status_code == 304
    )
    edit(api, job, 1, name(0, "body"))
    assert api.get(url, params={"revision": "latest"}).headers["ETag"] != one.headers["ETag"]
    assert api.get(url, params={"revision": 1}).headers["ETag"] == one.headers["ETag"]
    tags = [
        api.get(f"{job}/{result}", params={"revision": n}).headers["ETag"]
        for result in ("hierarchy", "result.cleave", "model.glb")
        for n in (0, 1, 2)
    ]
    assert len(set(tags)) == 9


def test_a_level_and_a_revision_exclude_each_other(api: httpx.Client, job: str) -> None:
    edit(api, job, 0, MERGE)
    for revision in ("1", "latest"):
        problem(api.get(f"{job}/labels", params={"revision": revision, "segments": 2}), 422, "invalid_parameters")
    problem(api.get(f"{job}/labels", params={"revision": 2}), 404, "revision_not_found")
    problem(api.get(f"{job}/labels", params={"revision": "newest"}), 422, "invalid_request")
    body = {"base": 1, "level": {"segments": 3}, "operations": [MERGE]}
    problem(api.post(f"{job}/edits", json=body), 422, "invalid_parameters")


def test_locked_parts_are_refused_if_an_operation_names_them(api: httpx.Client, job: str) -> None:
    edit(api, job, 0, {"op": "lock", "part": 0})
    problem(api.post(f"{job}/edits", json={"base": 1, "operations": [MERGE]}), 409, "part_locked")
    unlocked = edit(api, job, 1, {"op": "unlock", "part": 0}, MERGE)
    assert unlocked["revision"]["what"] == "unlock part 0; merge parts 0, 2"


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ("{", "invalid_parameters"),
        ('{"base": 0, "operations": []}', "invalid_parameters"),
        ('{"operations": [{"op": "lock", "part": 0}]}', "invalid_parameters"),
        ('{"base": 0, "operations": [{"op": "melt", "part": 0}]}', "invalid_parameters"),
        ('{"base": 0, "operations": [{"op": "lock", "part": 999}]}', "invalid_parameters"),
        ('{"base": 0, "operations": [{"op": "lock", "part": "0"}]}', "invalid_parameters"),
        ('{"base": 0, "operations": [{"op": "name", "part": 0, "name": "\\ud800"}]}', "invalid_parameters"),
        ('{"base": 0, "operations": [{"op": "name", "part": 0, "name": "  "}]}', "invalid_parameters"),
        ('{"base": 0, "operations": [{"op": "assign", "faces": [99999999], "to": 0}]}', "invalid_parameters"),
        (
            '{"base": 0, "operations": [{"op": "assign", "faces": {"starts": [0, 9], "lengths": [1]}, "to": 0}]}',
            "invalid_parameters",
        ),
        (
            '{"base": 0, "operations": [{"op": "assign", "faces": {"starts": [0], "lengths": [2000000000]}, "to": 0}]}',
            "invalid_parameters",
        ),
        ('{"base": 0, "level": {"segments": 999}, "operations": [{"op": "lock", "part": 0}]}', "invalid_parameters"),
        (
            '{"base": 0, "level": {"segments": 2, "splits": []}, "operations": [{"op": "lock", "part": 0}]}',
            "invalid_parameters",
        ),
    ],
)
def test_an_edit_that_is_none_is_refused_and_changes_nothing(api: httpx.Client, job: str, body: str, code: str) -> None:
    refused = problem(api.post(f"{job}/edits", content=body), 422, code)
    assert len(str(refused["detail"])) < 300
    assert api.get(f"{job}/revisions").json()["newest"] == 0


def test_an_edit_is_no_larger_than_its_mesh_needs(api: httpx.Client, job: str) -> None:
    problem(api.post(f"{job}/edits", content=b" " * (5 * 2**20)), 413, "too_large")


def test_jobs_of_others_and_deleted_jobs_have_no_revisions(
    api: httpx.Client, job: str, edit_store: JobStore, new_job: Callable[[], str]
) -> None:
    edit(api, job, 0, MERGE)
    other = {"Authorization": f"Bearer {OTHER_KEY}"}
    problem(api.get(f"{job}/revisions", headers=other), 404, "job_not_found")
    body = {"base": 1, "operations": [MERGE]}
    problem(api.post(f"{job}/edits", json=body, headers=other), 404, "job_not_found")
    api.delete(job)
    problem(api.get(f"{job}/revisions/1"), 410, "job_deleted")
    assert edit_store.objects.keys_below(f"jobs/{job.rpartition('/')[2]}") == []
    shared = new_job()
    assert api.get(shared).json()["revision"] == 0  # the result is shared, the edits are not


def test_a_damaged_revision_is_reported_and_replaced(api: httpx.Client, job: str, edit_store: JobStore) -> None:
    edit(api, job, 0, MERGE)
    edit(api, job, 1, name(0, "body"))
    key, _ = edit_store.objects.keys_below(f"jobs/{job.rpartition('/')[2]}/revisions")
    data = edit_store.objects.get(key) or b""
    edit_store.objects.put(key, data[:-9] + bytes([data[-9] ^ 1]) + data[-8:])
    problem(api.get(f"{job}/labels", params={"revision": 2}), 410, "revision_damaged")
    assert api.get(f"{job}/labels").status_code == 200
    found = api.get(f"{job}/revisions").json()
    assert (found["newest"], [one["number"] for one in found["revisions"]]) == (2, [1])
    problem(api.post(f"{job}/edits", json={"base": 2, "operations": [MERGE]}), 410, "revision_damaged")
    edit(api, job, 2, {"op": "restore", "revision": 1})
    assert labels(api, job, revision=3) == labels(api, job, revision=1)


def test_the_result_file_has_the_parts_and_the_list_of_revisions(api: httpx.Client, job: str) -> None:
    edit(api, job, 0, MERGE)
    edit(api, job, 1, name(0, "body"))
    result = read_result(io.BytesIO(api.get(f"{job}/result.cleave", params={"revision": "latest"}).content))
    assert result.edited is not None
    assert result.edited.partition.labels.tolist() == labels(api, job, revision=2)
    assert result.edited.partition.names == {0: "body"}
    assert [note.what for note in result.edited.revisions] == ["merge parts 0, 2", "name part 0 'body'"]
    plain = read_result(io.BytesIO(api.get(f"{job}/result.cleave").content))
    assert plain.edited is None
    assert plain.hierarchy.automatic_segments == result.hierarchy.automatic_segments


def test_labels_by_class_have_the_numbers_of_a_list(api: httpx.Client, job: str) -> None:
    problem(api.get(f"{job}/labels", params={"by": "class"}), 422, "invalid_parameters")
    edit(api, job, 0, {"op": "class", "part": 0, "class": "trunk"}, {"op": "class", "part": 2, "class": "limb"})
    parts = np.array(labels(api, job, revision=1))
    document = api.get(f"{job}/labels", params={"revision": 1, "by": "class"}).json()
    assert document["classes"] == ["", "limb", "trunk"]
    assert document["labels"] == np.where(parts == 0, 2, np.where(parts == 2, 1, 0)).tolist()
    ordered = {"revision": 1, "by": "class", "class": ["trunk", "limb"], "format": "seg"}
    text = api.get(f"{job}/labels", params=ordered).text
    assert [int(line) for line in text.splitlines()] == np.where(parts == 0, 1, np.where(parts == 2, 2, 0)).tolist()
    refused = {"revision": 1, "by": "class", "class": ["trunk"]}
    assert "'limb'" in str(problem(api.get(f"{job}/labels", params=refused), 422, "invalid_parameters")["detail"])
