"""The limits of a caller in the headers of a response."""

import httpx

from helpers.api import submit


def test_rate_limit_headers_count_unfinished_jobs(client: httpx.Client) -> None:
    headers = client.post("/v1/jobs", content=b"abc").headers
    assert headers["RateLimit-Policy"] == '"jobs";q=1000'
    assert headers["RateLimit"] == '"jobs";r=999'
    submit(client)
    assert client.post("/v1/jobs", content=b"abcd").headers["RateLimit"] == '"jobs";r=997'
