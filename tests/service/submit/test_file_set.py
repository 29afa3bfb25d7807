"""Models that are sent as several files."""

import hashlib
import io
import json
import zipfile

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import problem, traces
from helpers.files.samples import BINARY_STL, OBJ, OFF, gltf_square
from helpers.servers import serving
from helpers.uploads import post_zip, zip_of
from segcore.io import read_mesh
from worker.jobs.store.store import JobStore
from worker.process.perform import perform

Files = list[tuple[str, bytes]]

OBJ_SET = [
    ("a.obj", b"mtllib a.mtl\n" + OBJ),
    ("a.mtl", b"newmtl red\nmap_Kd images/t.png\n"),
    ("images/t.png", b"\x89PNG"),
]


def gltf_set(folder: str = "") -> Files:
    asset = gltf_square()
    asset.document["buffers"] = [{"byteLength": len(asset.binary), "uri": "the%20buffer.bin"}]
    return [(f"{folder}scene.gltf", json.dumps(asset.document).encode()), (f"{folder}the buffer.bin", asset.binary)]


def post(client: httpx.Client, files: Files, path: str = "/v1/jobs", **options: str) -> httpx.Response:
    return client.post(path, files=[("mesh", (name, data)) for name, data in files], params=options)


def stored(store: JobStore, job_id: str) -> bytes:
    with store.open_mesh(job_id) as mesh:
        return mesh.read()


def members(data: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.testzip() is None
        return {name: archive.read(name) for name in archive.namelist()}


def test_several_files_of_one_job_are_stored_as_one_archive(client: httpx.Client, store: JobStore) -> None:
    answer = post(client, [*OBJ_SET, (".DS_Store", b"x")])
    assert answer.status_code == 202, answer.text
    job = answer.json()
    data = stored(store, job["id"])
    assert members(data) == dict(OBJ_SET)
    assert job["input"] == {
        "file_name": "a.obj",
        "format": None,
        "size_bytes": len(data),
        "sha256": hashlib.sha256(data).hexdigest(),
    }
    assert len(read_mesh(io.BytesIO(data)).faces) == 2


def test_equal_sets_have_equal_bytes_whatever_their_order(client: httpx.Client) -> None:
    hashes = {post(client, files).json()["input"]["sha256"] for files in (OBJ_SET, OBJ_SET[::-1])}
    assert len(hashes) == 1
    assert post(client, [*OBJ_SET[:2], ("images/u.png", b"\x89PNG")]).json()["input"]["sha256"] not in hashes


def test_a_set_is_segmented_like_any_mesh(client: httpx.Client, store: JobStore, settings: Settings) -> None:
    job = post(client, gltf_set("scenes/")).json()
    perform(store, settings, job["id"], lambda *_: None)
    done = client.get(f"/v1/jobs/{job['id']}").json()
    assert (done["status"], done["mesh"]["faces"]) == ("succeeded", 2)


@pytest.mark.parametrize(
    ("files", "sentence"),
    [
        (
            [*OBJ_SET, ("b.stl", BINARY_STL)],
            "has 2 meshes (a.obj, b.stl): send one mesh with the files that it refers to",
        ),
        (OBJ_SET[1:], "None of the files is a mesh by its extension: a.mtl, images/t.png."),
        ([*OBJ_SET, ("A.MTL", b"")], "Two files are called 'A.MTL', if case does not matter"),
        ([*OBJ_SET, ("./images/../a.mtl", b"")], "Two files are called 'a.mtl'"),
        ([*OBJ_SET, ("../t.png", b"")], "'../t.png' cannot be used"),
        ([*OBJ_SET, ("/t.png", b"")], "'/t.png' cannot be used"),
        ([*OBJ_SET, ("..\\t.png", b"")], "cannot be used"),
        ([*OBJ_SET, ("images/../../t.png", b"")], "cannot be used"),
        ([*OBJ_SET, ("x" * 2000, b"")], "cannot be used"),
    ],
)
def test_a_set_that_is_not_one_model_is_refused_and_leaves_nothing(
    client: httpx.Client, settings: Settings, files: Files, sentence: str
) -> None:
    assert sentence in str(problem(post(client, files), 422, "invalid_file_set")["detail"])
    assert traces(settings.data_dir) == []


def test_the_limits_hold_for_all_files_together(client: httpx.Client, settings: Settings) -> None:
    most = settings.max_upload_bytes
    problem(post(client, [OBJ_SET[0], ("t.png", bytes(most))]), 413, "too_large")
    problem(post(client, [OBJ_SET[0], *((f"{n}.png", bytes(most // 3)) for n in range(3))]), 413, "too_large")
    problem(post(client, [OBJ_SET[0], *((f"{n}.png", b"") for n in range(1000))]), 413, "too_large")
    problem(post(client, [("a.obj", b""), *OBJ_SET[1:]]), 422, "invalid_mesh")
    assert traces(settings.data_dir) == []


def test_a_batch_gives_each_model_the_files_that_it_refers_to(client: httpx.Client, store: JobStore) -> None:
    others = [("b.off", OFF), ("noname", OFF), ("notes.txt", b"hello"), ("other/a.mtl", b""), ("../t.png", b"")]
    files = [*OBJ_SET, *gltf_set("g/"), *others, ("__MACOSX/._b.txt", b"")]
    for answer in (post(client, files, "/v1/batches"), post_zip(client, zip_of(dict(files)))):
        assert answer.status_code == 202, answer.text
        batch = answer.json()
        assert [job["file_name"] for job in batch["jobs"]] == ["a.obj", "scene.gltf", "b.off", "noname"]
        assert set(batch["left_out"]) - {"../t.png"} == {"notes.txt", "other/a.mtl"}
        assert client.get(answer.headers["Location"]).json()["left_out"] == batch["left_out"]
        data = [stored(store, job["id"]) for job in batch["jobs"]]
        assert members(data[0]) == dict(OBJ_SET)
        assert members(data[1]) == dict(gltf_set("g/"))
        assert data[2:] == [OFF, OFF]


def test_a_shared_file_belongs_to_each_model_of_a_batch_within_the_limits(settings: Settings) -> None:
    models = [(f"{n}.obj", b"mtllib a.mtl\n#%d\n" % n + OBJ) for n in range(3)]
    shared = [("a.mtl", b"map_Kd t.png\n"), ("t.png", bytes(100_000))]
    with serving(settings.model_copy(update={"max_batch_bytes": 320_000})) as client:
        assert len(post(client, models + shared, "/v1/batches").json()["jobs"]) == 3
    with serving(settings.model_copy(update={"max_batch_bytes": 290_000})) as client:
        problem(post(client, models + shared, "/v1/batches"), 413, "too_large")


def test_a_batch_without_a_mesh_names_its_files(client: httpx.Client) -> None:
    for answer in (post(client, OBJ_SET[1:], "/v1/batches"), post_zip(client, zip_of(dict(OBJ_SET[1:])))):
        assert "a.mtl" in str(problem(answer, 422, "invalid_file_set")["detail"])
