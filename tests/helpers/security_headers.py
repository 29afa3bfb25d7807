"""The security headers of a response."""

import httpx

_POLICY = ("form-action 'self'", "base-uri 'none'", "frame-ancestors 'none'")


def check_security_headers(answer: httpx.Response) -> None:
    policy = answer.headers["Content-Security-Policy"]
    assert policy.startswith(("default-src 'self'", "default-src 'none'")), answer.request.url
    assert all(part in policy for part in _POLICY)
    assert "unsafe" not in policy
    assert "http" not in policy
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert answer.headers["Referrer-Policy"] == "no-referrer"
    assert answer.headers["Cross-Origin-Opener-Policy"] == "same-origin"
