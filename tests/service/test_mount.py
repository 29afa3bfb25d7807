"""Links are right below the path at which a proxy shows the service."""

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import submit
from helpers.jobs import sphere
from helpers.servers import serving

PREFIX = {"X-Forwarded-Prefix": "/tools/cleave"}


@pytest.mark.parametrize("path", ["/v1/jobs", "/tools/cleave/v1/jobs"])
def test_links_have_the_prefix_of_the_proxy_whether_it_removes_it_or_not(client: httpx.Client, path: str) -> None:
    answer = client.post(path, files={"mesh": ("mesh.off", sphere(12))}, headers=PREFIX)
    job = answer.json()["id"]
    assert answer.status_code == 202
    assert answer.headers["Location"] == f"/tools/cleave/v1/jobs/{job}"
    assert set(answer.json()["links"].values()) == {
        link.replace("/v1", "/tools/cleave/v1") for link in client.get(f"/v1/jobs/{job}").json()["links"].values()
    }
    assert client.get(answer.headers["Location"], headers=PREFIX).json()["id"] == job


def test_batches_and_the_openapi_document_have_the_prefix(client: httpx.Client) -> None:
    job = submit(client).rpartition("/")[2]
    batch = client.post("/v1/batches", json={"jobs": [job]}, headers=PREFIX).json()
    assert batch["links"]["self"].startswith("/tools/cleave/v1/batches/")
    assert batch["jobs"][0]["self"] == f"/tools/cleave/v1/jobs/{job}"
    document = client.get("/openapi.json", headers=PREFIX).json()
    assert document["servers"] == [{"url": "/tools/cleave"}]
    assert "servers" not in client.get("/openapi.json").json()


@pytest.mark.parametrize("path", ["/", "/tools/cleave/", "/tools/cleave"])
def test_the_page_is_shown_below_the_prefix(client: httpx.Client, path: str) -> None:
    assert "<title>Cleave" in client.get(path, headers=PREFIX).text


def test_the_setting_counts_if_the_proxy_sends_no_header(settings: Settings) -> None:
    with serving(settings.model_copy(update={"root_path": "/cleave"})) as client:
        assert submit(client).startswith("/cleave/v1/jobs/")
        assert client.get("/cleave/healthz").status_code == 200
        other = client.get("/v1/jobs", headers=PREFIX).json()["jobs"][0]["links"]["self"]
        assert other.startswith("/tools/cleave/v1/jobs/")


@pytest.mark.parametrize(
    "header", ["//evil.example", "https://evil.example", "cleave", "/a/../b", "/a b", "/a?b", '/"><script>', ""]
)
def test_a_header_that_is_no_path_is_ignored(client: httpx.Client, header: str) -> None:
    answer = client.post("/v1/jobs", files={"mesh": ("a.off", sphere(12))}, headers={"X-Forwarded-Prefix": header})
    assert answer.headers["Location"].startswith("/v1/jobs/")


def test_files_of_the_page_are_compressed_if_the_client_takes_that(client: httpx.Client) -> None:
    plain, packed = (
        client.get("/viewer/page.js", headers={"Accept-Encoding": coding}) for coding in ("identity", "gzip, br")
    )
    assert packed.headers["Content-Encoding"] == "gzip"
    assert "Content-Encoding" not in plain.headers
    assert packed.content == plain.content
    assert int(packed.headers["Content-Length"]) < int(plain.headers["Content-Length"]) / 2
    assert packed.headers["ETag"] != plain.headers["ETag"]
    again = {"Accept-Encoding": "gzip", "If-None-Match": packed.headers["ETag"]}
    assert client.get("/viewer/page.js", headers=again).status_code == 304
