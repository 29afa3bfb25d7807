"""Bodies of submissions: forms, ZIP archives and interrupted requests."""

import io
import zipfile
from collections.abc import Iterator

import httpx
from starlette.requests import Request

BOUNDARY = "----boundary"
CONTENT_TYPE = f"multipart/form-data; boundary={BOUNDARY}"


def part(name: str, content: bytes, extra: str = "") -> bytes:
    """Return one field of a form."""
    head = f'--{BOUNDARY}\r\nContent-Disposition: form-data; name="{name}"{extra}\r\n\r\n'
    return head.encode() + content + b"\r\n"


def form(*parts: bytes) -> bytes:
    """Return the body of a form."""
    return b"".join(parts) + f"--{BOUNDARY}--\r\n".encode()


def post_form(client: httpx.Client, body: bytes | Iterator[bytes], content_type: str = CONTENT_TYPE) -> tuple[int, str]:
    """Submit a form; return the status and the code of the problem."""
    answer = client.post("/v1/jobs", content=body, headers={"Content-Type": content_type})
    return answer.status_code, answer.json().get("code", "")


def interrupted_request(chunks: list[bytes], **headers: str) -> Request:
    """Return a request whose client disconnects after some chunks."""
    messages = [{"type": "http.request", "body": chunk, "more_body": True} for chunk in chunks]
    messages.append({"type": "http.disconnect"})
    source = iter(messages)

    async def receive() -> dict[str, object]:
        return next(source)

    raw = [(name.replace("_", "-").encode(), value.encode()) for name, value in headers.items()]
    return Request({"type": "http", "method": "POST", "headers": raw}, receive)


def zip_of(members: dict[str, bytes], compression: int = zipfile.ZIP_DEFLATED) -> bytes:
    """Return a ZIP archive."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", compression) as file:
        for name, data in members.items():
            file.writestr(name, data)
    return target.getvalue()


def post_zip(client: httpx.Client, data: bytes) -> httpx.Response:
    """Submit a ZIP archive as a batch."""
    return client.post("/v1/batches", content=data, headers={"Content-Type": "application/zip"})
