"""Pages of other sites cannot use a service of their visitor."""

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import problem
from helpers.servers import serving
from service.keys import key_digest, new_key

KEYS = f"anna:{key_digest(new_key())}"


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
        refused = foreign | {"Origin": "https://third.example"}
        problem(client.post("/v1/jobs", content=b"abc", headers=refused), 403, "foreign_site")
        preflight = {"Origin": "https://other.example", "Access-Control-Request-Method": "POST"}
        assert client.options("/v1/jobs", headers=preflight).status_code == 200


@pytest.mark.parametrize(
    "host", ["localhost:8000", "127.0.0.1", "[::1]:8000", "10.1.2.3:80", "cleave.localhost", "LOCALHOST"]
)
def test_without_keys_localhost_and_addresses_are_accepted(client: httpx.Client, host: str) -> None:
    assert client.get("/v1/formats", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize(
    "host", ["rebound.example", "rebound.example:8000", "127.0.0.1.example", "localhost.example", "x"]
)
def test_without_keys_other_host_names_are_refused(client: httpx.Client, settings: Settings, host: str) -> None:
    for method, path in (("GET", "/v1/jobs"), ("POST", "/v1/jobs"), ("GET", "/")):
        problem(client.request(method, path, headers={"Host": host}), 403, "foreign_site")
    for choice in ({"auth": "off"}, {"api_keys": KEYS}):
        with serving(settings.model_copy(update=choice)) as other:
            assert other.get("/healthz", headers={"Host": host}).status_code == 200


def test_a_slash_at_the_end_of_an_allowed_origin_does_not_matter(settings: Settings) -> None:
    with serving(settings.model_copy(update={"cors_origins": "https://other.example/"})) as client:
        answer = client.get("/v1/formats", headers={"Origin": "https://other.example"})
        assert answer.headers["Access-Control-Allow-Origin"] == "https://other.example"


def test_a_star_allows_pages_of_every_origin(settings: Settings) -> None:
    foreign = {"Sec-Fetch-Site": "cross-site", "Origin": "https://any.example"}
    with serving(settings.model_copy(update={"cors_origins": "*"})) as client:
        answer = client.post("/v1/jobs", content=b"abc", headers=foreign)
        assert (answer.status_code, answer.headers["Access-Control-Allow-Origin"]) == (202, "*")
        refusal = client.get("/v1/jobs/" + "0" * 32, headers=foreign)
        assert (refusal.status_code, refusal.headers["Access-Control-Allow-Origin"]) == (404, "*")
