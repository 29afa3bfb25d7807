"""API keys: each sees its own jobs, none sees others', and without one nothing is told."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from cleave.settings import InvalidSettings, Settings
from helpers.api import UNKNOWN, problem, submit
from helpers.servers import serving
from service.commands.serve import check_guarded
from service.keys import key_digest, key_ring, new_key, parse_keys

ANNA, BORIS = new_key(), new_key()
KEYS = f"anna:{key_digest(ANNA)}, boris:{key_digest(BORIS)}"


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


@pytest.fixture
def guarded(settings: Settings) -> Iterator[httpx.Client]:
    with serving(settings.model_copy(update={"api_keys": KEYS})) as client:
        yield client


@pytest.mark.parametrize("headers", [{}, bearer("wrong"), {"Authorization": "Basic YTpi"}, bearer("\xff")])
def test_without_a_key_nothing_is_told(guarded: httpx.Client, headers: dict[str, str]) -> None:
    raw = {name: value.encode("latin-1") for name, value in headers.items()}
    for method, path in (
        ("POST", "/v1/jobs"),
        ("GET", "/v1/jobs"),
        ("GET", UNKNOWN),
        ("DELETE", UNKNOWN),
        ("GET", f"{UNKNOWN}/labels"),
        ("GET", f"{UNKNOWN}/events"),
        ("GET", "/v1/webhooks/secret"),
        ("GET", "/metrics"),
    ):
        answer = guarded.request(method, path, headers=raw, content=b"abc" if method == "POST" else None)
        problem(answer, 401, "unauthorized")
        assert answer.headers["WWW-Authenticate"] == "Bearer"
    for path in ("/healthz", "/openapi.json", "/v1/formats", "/v1/methods"):
        assert guarded.get(path).status_code == 200


def test_jobs_belong_to_the_key_that_submitted_them(guarded: httpx.Client) -> None:
    guarded.headers.update(bearer(ANNA))
    path = submit(guarded)
    assert [job["links"]["self"] for job in guarded.get("/v1/jobs").json()["jobs"]] == [path]
    guarded.headers.update(bearer(BORIS))
    assert guarded.get("/v1/jobs").json()["jobs"] == []
    for answer in (
        guarded.get(path),
        guarded.get(f"{path}/labels"),
        guarded.get(f"{path}/events"),
        guarded.post(f"{path}/cancel"),
        guarded.delete(path),
    ):
        problem(answer, 404, "job_not_found")
    guarded.headers.update(bearer(ANNA))
    assert guarded.delete(path).status_code == 204
    problem(guarded.get(path), 410, "job_deleted")
    problem(guarded.get(path, headers=bearer(BORIS)), 404, "job_not_found")


def test_the_same_idempotency_key_of_two_callers_is_two_keys(guarded: httpx.Client) -> None:
    answers = [
        guarded.post("/v1/jobs", content=b"abc", headers={"Idempotency-Key": "k", **bearer(key)})
        for key in (ANNA, BORIS)
    ]
    assert len({answer.headers["Location"] for answer in answers}) == 2


def test_a_limit_is_each_keys_own(settings: Settings) -> None:
    limits = {"api_keys": KEYS, "key_max_queued_jobs": 2, "max_queued_jobs": 3}
    with serving(settings.model_copy(update=limits)) as client:
        client.headers.update(bearer(ANNA))
        paths = [submit(client), submit(client)]
        refused = client.post("/v1/jobs", content=b"abc")
        problem(refused, 429, "too_many_jobs")
        assert refused.headers["RateLimit"] == '"jobs";r=0'
        assert int(refused.headers["Retry-After"]) > 0
        client.headers.update(bearer(BORIS))
        submit(client)
        problem(client.post("/v1/jobs", content=b"abc"), 429, "queue_full")
        client.delete(paths[0], headers=bearer(ANNA))
        submit(client)


def test_the_bytes_of_an_hour_are_counted(settings: Settings) -> None:
    with serving(settings.model_copy(update={"key_upload_bytes_per_hour": 1000})) as client:
        first = client.post("/v1/jobs", content=b"x" * 600)
        assert '"upload";q=1000;qu="content-bytes";w=3600' in first.headers["RateLimit-Policy"]
        assert '"upload";r=400;t=' in first.headers["RateLimit"]
        refused = client.post("/v1/jobs", content=b"x" * 600)
        problem(refused, 429, "too_many_bytes")
        assert 0 < int(refused.headers["Retry-After"]) <= 3600


def test_keys_in_a_file_come_and_go_while_it_is_served(tmp_path: Path) -> None:
    file = tmp_path / "keys"
    file.write_text(f"# people\n\nanna {key_digest(ANNA)}\n")
    ring = key_ring(Settings(api_keys_file=file, api_keys=f"boris:{key_digest(BORIS)}"))
    assert (ring.owner_of(ANNA), ring.owner_of(BORIS), ring.owner_of("other")) == ("anna", "boris", None)
    file.write_text("")
    assert (ring.owner_of(ANNA), ring.owner_of(BORIS)) == (None, "boris")


@pytest.mark.parametrize("entry", ["anna", "anna:secret", "Anna:" + "0" * 64, "../x:" + "0" * 64, "_:" + "0" * 64])
def test_an_entry_that_is_none_is_refused_without_being_shown(entry: str) -> None:
    with pytest.raises(InvalidSettings, match="Entry 1 of HERE") as refused:
        parse_keys([entry], "HERE")
    assert entry not in str(refused.value)


@pytest.mark.parametrize(
    ("address", "settings", "fine"),
    [
        ("127.0.0.1", Settings(), True),
        ("::1", Settings(), True),
        ("0.0.0.0", Settings(), False),
        ("192.168.1.7", Settings(), False),
        ("0.0.0.0", Settings(auth="off"), True),
        ("0.0.0.0", Settings(api_keys=KEYS), True),
        ("127.0.0.1", Settings(auth="required"), False),
        ("127.0.0.1", Settings(auth="required", api_keys=KEYS), True),
    ],
)
def test_nobody_serves_strangers_by_oversight(address: str, settings: Settings, fine: bool) -> None:
    if fine:
        check_guarded(settings, address)
    else:
        with pytest.raises(InvalidSettings, match="cleave key NAME"):
            check_guarded(settings, address)


def test_pages_of_other_sites_cannot_submit_unless_they_are_allowed(settings: Settings) -> None:
    foreign = {"Sec-Fetch-Site": "cross-site", "Origin": "https://other.example"}
    with serving(settings) as client:
        problem(client.post("/v1/jobs", content=b"abc", headers=foreign), 403, "foreign_site")
        assert client.post("/v1/jobs", content=b"abc", headers={"Sec-Fetch-Site": "same-origin"}).status_code == 202
        assert "Access-Control-Allow-Origin" not in client.get("/v1/formats", headers=foreign).headers
    with serving(settings.model_copy(update={"cors_origins": "https://other.example"})) as client:
        allowed = client.post("/v1/jobs", content=b"abc", headers=foreign)
        assert allowed.status_code == 202
        assert allowed.headers["Access-Control-Allow-Origin"] == "https://other.example"
        assert "Location" in allowed.headers["Access-Control-Expose-Headers"]
        stranger = foreign | {"Origin": "https://third.example"}
        problem(client.post("/v1/jobs", content=b"abc", headers=stranger), 403, "foreign_site")
        asked = {"Origin": "https://other.example", "Access-Control-Request-Method": "POST"}
        assert client.options("/v1/jobs", headers=asked).status_code == 200


@pytest.mark.parametrize(
    "host", ["localhost:8000", "127.0.0.1", "[::1]:8000", "10.1.2.3:80", "cleave.localhost", "LOCALHOST"]
)
def test_without_keys_this_machine_and_addresses_are_answered(client: httpx.Client, host: str) -> None:
    assert client.get("/v1/formats", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize(
    "host", ["rebound.example", "rebound.example:8000", "127.0.0.1.example", "localhost.example", "x"]
)
def test_without_keys_no_other_name_is_answered(client: httpx.Client, settings: Settings, host: str) -> None:
    for method, path in (("GET", "/v1/jobs"), ("POST", "/v1/jobs"), ("GET", "/")):
        problem(client.request(method, path, headers={"Host": host}), 403, "foreign_site")
    for choice in ({"auth": "off"}, {"api_keys": KEYS}):
        with serving(settings.model_copy(update=choice)) as other:
            assert other.get("/healthz", headers={"Host": host}).status_code == 200


def test_every_answer_says_what_a_browser_may_do_with_it(client: httpx.Client) -> None:
    for path in ("/v1/formats", UNKNOWN, "/nowhere", "/openapi.json"):
        headers = client.get(path).headers
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert "default-src 'self'" in headers["Content-Security-Policy"]
        assert "unsafe" not in headers["Content-Security-Policy"]
