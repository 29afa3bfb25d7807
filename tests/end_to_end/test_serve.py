"""`cleave serve` in normal use: from POST to GLB, cancelation, and restarts of its processes."""

import json
import os
import signal
import socket
import struct
import threading
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest

from helpers.files.samples import gltf_square
from helpers.installation import Installation
from helpers.jobs import LONG, sphere
from helpers.processes import is_alive
from helpers.uploads import zip_of
from helpers.waiting import wait_until


@pytest.fixture(scope="module")
def installation() -> Iterator[Installation]:
    with Installation() as installation:
        yield installation


def finished(installation: Installation, path: str) -> dict[str, object]:
    wait_until(lambda: installation.status(path) in ("succeeded", "failed", "canceled"))
    document: dict[str, object] = installation.get(path).json()
    return document


def test_a_submitted_mesh_is_segmented(installation: Installation) -> None:
    path = installation.submit(sphere(40))
    job = finished(installation, path)
    assert job["status"] == "succeeded", job
    labels = installation.get(f"{path}/labels?segments=4").json()
    assert set(labels["labels"]) == {0, 1, 2, 3}
    assert len(labels["labels"]) == 4 * 40 * 39
    model = installation.get(f"{path}/model.glb?segments=4").content
    length, kind = struct.unpack_from("<I4s", model, 12)
    scene = json.loads(model[20 : 20 + length])
    assert (model[:4], kind) == (b"glTF", b"JSON")
    assert len(scene["meshes"]) == 4
    assert len(installation.get(f"{path}/hierarchy").json()["nodes"]) == 2 * int(str(job["max_segments"])) - 1


def test_a_bad_mesh_fails_with_its_error_code(installation: Installation) -> None:
    job = finished(installation, installation.submit(b"OFF\n1 0 0\n0 0 0\n"))
    assert job["status"] == "failed"
    assert job["error"]["code"] == "invalid_mesh"  # type: ignore[index]


def test_a_mesh_in_an_archive_is_segmented_with_the_files_that_it_refers_to(installation: Installation) -> None:
    asset = gltf_square()
    asset.document["buffers"] = [{"byteLength": len(asset.binary), "uri": "data/square.bin"}]
    scene, readme = json.dumps(asset.document).encode(), b"two faces"
    body = zip_of({"model/scene.gltf": scene, "model/data/square.bin": asset.binary, "model/readme.txt": readme})
    for content_type in ("application/zip", "application/octet-stream"):
        headers = {"Content-Type": content_type, "Cache-Control": "no-cache"}
        answer = httpx.post(f"{installation.url}/v1/jobs", content=body, headers=headers, timeout=60)
        assert answer.status_code in (200, 202), answer.text
        job = finished(installation, str(answer.headers["Location"]))
        assert job["status"] == "succeeded", job
        assert job["mesh"]["report"]["faces"] == 2  # type: ignore[index]
    two = zip_of({"a.off": sphere(8), "b.off": sphere(9)})
    answer = httpx.post(f"{installation.url}/v1/jobs", files={"mesh": ("two.zip", two)}, timeout=60)
    job = finished(installation, str(answer.headers["Location"]))
    assert job["status"] == "failed"
    assert "2 meshes (a.off, b.off)" in job["error"]["message"]  # type: ignore[index]


def test_progress_is_reported_and_never_decreases(installation: Installation) -> None:
    path = installation.submit(sphere(100), json.dumps(LONG))
    seen: list[dict[str, object]] = []
    while not seen or seen[-1]["status"] in ("queued", "running"):
        seen.append(installation.get(path).json())
    running = [job for job in seen if job["status"] == "running"]
    fractions = [float(str(job["progress"])) for job in running]
    assert fractions == sorted(fractions)
    assert len({job["stage"] for job in running} - {None}) >= 2
    assert seen[-1]["status"] == "succeeded"


def test_concurrent_cancels_stop_a_running_job_once(installation: Installation) -> None:
    path = installation.submit(sphere(100), json.dumps(LONG))
    wait_until(lambda: installation.status(path) == "running" and installation.horses())
    horses = installation.horses()
    answers: list[int] = []
    threads = [
        threading.Thread(target=lambda: answers.append(httpx.post(f"{installation.url}{path}/cancel").status_code))
        for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers == [200] * 8
    wait_until(lambda: not any(is_alive(horse) for horse in horses), within_s=20)
    assert installation.status(path) == "canceled"
    assert finished(installation, installation.submit(sphere(12)))["status"] == "succeeded"


def test_a_deleted_job_leaves_no_file(installation: Installation) -> None:
    before = installation.files()
    path = installation.submit(sphere(100), json.dumps(LONG))
    wait_until(lambda: installation.status(path) == "running")
    assert httpx.delete(installation.url + path).status_code == 204
    wait_until(lambda: not installation.horses())
    assert installation.files() == before


def test_a_second_service_on_the_same_data_is_refused(installation: Installation) -> None:
    second = installation.command("serve", "--port", "0")
    output, _ = second.communicate(timeout=60)
    assert (second.returncode, output) == (2, "")
    assert installation.is_ready()


def test_an_interrupted_upload_leaves_no_file(installation: Installation) -> None:
    before = installation.files()
    address = urlsplit(installation.url)
    head = (
        f"POST /v1/jobs HTTP/1.1\r\nHost: {address.netloc}\r\nContent-Length: 4000000\r\n"
        "Content-Type: multipart/form-data; boundary=b\r\n\r\n"
        '--b\r\nContent-Disposition: form-data; name="mesh"; filename="a.off"\r\n\r\n'
    )
    with socket.create_connection((str(address.hostname), int(str(address.port)))) as connection:
        connection.sendall(head.encode() + b"half of a mesh " * 100_000)
        wait_until(lambda: installation.files() != before)
    wait_until(lambda: installation.files() == before)


def test_a_large_upload_is_not_held_in_memory(installation: Installation) -> None:
    def megabytes() -> Iterator[bytes]:
        yield b'--b\r\nContent-Disposition: form-data; name="mesh"\r\n\r\n'
        for _ in range(128):
            yield bytes(2**20)
        yield b"\r\n--b--\r\n"

    (service,) = installation.children("service.host.http_server")
    before = peak_bytes(service)
    content_type = {"Content-Type": "multipart/form-data; boundary=b"}
    answer = httpx.post(f"{installation.url}/v1/jobs", content=megabytes(), headers=content_type, timeout=120)
    assert answer.status_code in (200, 202), answer.text  # 200: the job has ended already
    assert peak_bytes(service) - before < 32 * 2**20
    assert httpx.delete(installation.url + answer.headers["Location"]).status_code == 204


def peak_bytes(pid: int) -> int:
    """Return the peak resident memory of a process."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def test_a_wiped_queue_loses_no_job(installation: Installation) -> None:
    paths = [installation.submit(sphere(60)) for _ in range(6)]
    with installation.redis() as connection:
        connection.flushall()
    paths += [installation.submit(sphere(60)) for _ in range(2)]
    wait_until(lambda: installation.statuses(paths) == {"succeeded"})


@pytest.mark.parametrize("name", ["service.host.http_server", "worker.janitor"])
def test_a_killed_process_is_restarted(installation: Installation, name: str) -> None:
    (killed,) = installation.children(name)
    os.kill(killed, signal.SIGKILL)
    assert finished(installation, installation.submit(sphere(12)))["status"] == "succeeded"
    wait_until(lambda: installation.children(name) not in ([], [killed]))


def test_a_hung_queue_server_delays_no_request_that_does_not_need_it(installation: Installation) -> None:
    path = installation.submit(sphere(12))
    finished(installation, path)
    (server,) = installation.children("queue.sock")
    os.kill(server, signal.SIGSTOP)
    try:
        refused = httpx.post(f"{installation.url}/v1/jobs", files={"mesh": ("a.off", sphere(12))}, timeout=30)
        assert refused.json()["code"] == "queue_unavailable"
        assert int(refused.headers["Retry-After"]) > 0
        assert refused.elapsed.total_seconds() < 10  # about 2 s on an idle machine
        assert installation.get(f"{path}/labels").status_code == 200
        assert installation.get("/healthz").status_code == 200
        assert installation.get("/readyz").status_code == 503
    finally:
        os.kill(server, signal.SIGCONT)
    wait_until(installation.is_ready)
