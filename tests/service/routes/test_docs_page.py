"""The API reference at /docs."""

import re

import httpx


def test_the_reference_loads_nothing_from_other_servers(client: httpx.Client) -> None:
    page = client.get("/docs")
    assert page.headers["Content-Type"].startswith("text/html")
    assert "default-src 'self'" in page.headers["Content-Security-Policy"]
    assert "<script" not in page.text
    for address in re.findall(r'(?:src|href)="([^"]*)"', page.text):
        assert client.get(address).status_code == 200
    assert "/v1/jobs/{job_id}/labels" in page.text
    assert "idempotency_key_reused" in page.text
