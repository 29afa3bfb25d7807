"""What can go wrong between a client and a server.

ClientError
 |- ServerUnreachable   nobody answers: start the server, or look at the URL
 |- RequestRefused      the server says no; ``code`` and the message say why
 `- JobEnded            the job has no result: it failed or was canceled
"""

from cleave.client.documents import Job


class ClientError(Exception):
    """Any of them."""


class ServerUnreachable(ClientError):  # noqa: N818
    """No answer came, also not after a few tries."""


class RequestRefused(ClientError):  # noqa: N818
    """The server answered with a problem (RFC 9457)."""

    def __init__(self, status: int, code: str, detail: str, retry_after_s: float | None = None) -> None:
        super().__init__(detail)
        self.status = status
        self.code = code
        self.retry_after_s = retry_after_s


class JobEnded(ClientError):  # noqa: N818
    """There is no result, and there will be none."""

    def __init__(self, job: Job) -> None:
        reason = job.error.message if job.error else "it was canceled."
        super().__init__(f"The job has no result: {reason}")
        self.job = job
