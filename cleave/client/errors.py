"""The errors of the client.

ClientError
 |- ServerUnreachable   no response: start the server, or check the URL
 |- RequestRefused      the server has refused the request; ``code`` and the message give the reason
 `- JobEnded            the job has no result: it failed or was canceled
"""

from cleave.client.documents import Job


class ClientError(Exception):
    """Base class of the errors of the client."""


class ServerUnreachable(ClientError):  # noqa: N818
    """The server did not answer, even after several attempts."""


class RequestRefused(ClientError):  # noqa: N818
    """The server answered with a problem document (RFC 9457)."""

    def __init__(self, status: int, code: str, detail: str, retry_after_s: float | None = None) -> None:
        super().__init__(detail)
        self.status = status
        self.code = code
        self.retry_after_s = retry_after_s


class JobEnded(ClientError):  # noqa: N818
    """The job has ended without a result."""

    def __init__(self, job: Job) -> None:
        reason = job.error.message if job.error else "it was canceled."
        super().__init__(f"The job has no result: {reason}")
        self.job = job
