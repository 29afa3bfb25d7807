"""Extraction of untrusted ZIP archives."""

import struct
from pathlib import Path

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import problem, traces
from helpers.jobs import sphere
from helpers.servers import serving
from helpers.uploads import post_zip, zip_of
from worker.jobs.store.store import JobStore

MESHES = {f"mesh{rows}.off": sphere(rows) for rows in (10, 11, 12)}


def test_an_archive_of_meshes_is_a_batch(client: httpx.Client, store: JobStore) -> None:
    members = {f"folder/{name}": data for name, data in MESHES.items()}
    answer = post_zip(client, zip_of(members | {"__MACOSX/._mesh": b"x", "folder/.DS_Store": b"x", "folder/": b""}))
    assert answer.status_code == 202, answer.text
    jobs = answer.json()["jobs"]
    assert [job["file_name"] for job in jobs] == list(MESHES)
    for job, data in zip(jobs, MESHES.values(), strict=True):
        with store.open_mesh(job["id"]) as mesh:
            assert mesh.read() == data


def lying_directory(data: bytes) -> bytes:
    """Return an archive with a declared central directory of a gigabyte."""
    at = data.rfind(b"PK\5\6")
    return data[: at + 12] + struct.pack("<I", 2**30) + data[at + 16 :]


MANY = zip_of({f"{number}.off": b"x" for number in range(6)})


@pytest.mark.parametrize(
    ("data", "status", "code"),
    [
        (b"", 400, "malformed_request"),
        (b"PK\3\4 no archive", 400, "malformed_request"),
        (zip_of({}), 400, "malformed_request"),
        (zip_of(MESHES)[:-30], 400, "malformed_request"),
        (zip_of({"a.off": b"abc"}).replace(b"a.off", b"\0.off"), 400, "malformed_request"),  # an empty name
        (zip_of({"a.off": b"abc", "b.off": b""}), 422, "invalid_mesh"),
        (zip_of({"bomb.off": bytes(50_000_000)}), 413, "too_large"),
        (zip_of({f"{number}.off": bytes(150_000) for number in range(4)}), 413, "too_large"),
        (MANY, 413, "too_large"),
        (lying_directory(zip_of(MESHES)), 413, "too_large"),
        (zip_of(MESHES).replace(b"PK\1\2", b"PK\1\3"), 400, "malformed_request"),
    ],
)
def test_an_archive_that_cannot_be_used_is_refused_and_leaves_nothing(
    settings: Settings, data: bytes, status: int, code: str
) -> None:
    with serving(settings.model_copy(update={"max_batch_jobs": 5, "max_batch_bytes": 500_000})) as client:
        problem(post_zip(client, data), status, code)
    assert traces(settings.data_dir) == []


def test_a_name_in_an_archive_is_never_a_path(client: httpx.Client, tmp_path: Path, settings: Settings) -> None:
    names = ["../../escape", "/escape", "C:\\escape", "..\\escape"]
    answer = post_zip(client, zip_of({f"{name}{number}.off": b"abc" for number, name in enumerate(names)}))
    assert answer.status_code == 202
    assert len(answer.json()["jobs"]) == 2  # names that begin with a dot count as hidden
    assert list(tmp_path.rglob("*escape*")) == []
    assert {file.name[:5] for file in (settings.data_dir / "jobs").rglob("*") if file.is_file()} == {"mesh-", "job.j"}
