"""How much a caller may still ask for, and the headers that say so (draft-ietf-httpapi-ratelimit-headers-10)."""

from service.context import Context
from service.guard.callers import Caller
from service.problems import Problem
from worker.jobs.queue.quota import WINDOW_S

_RETRY_S = 5  # by then a job may have ended


def check_limits(context: Context, caller: Caller, jobs: int, declared_bytes: int) -> dict[str, str]:
    """The RateLimit headers of the answer to somebody who wants to submit some jobs.

    Raises
    ------
    Problem
        Where that would be more than the caller, or the installation, may have.
    """
    settings = context.settings
    everybodys, callers = context.store.pending.count(caller.owner)
    policies = [f'"jobs";q={settings.key_max_queued_jobs}']
    left = [f'"jobs";r={max(0, settings.key_max_queued_jobs - callers - jobs)}']
    refusals: list[tuple[bool, str, str, int]] = [
        (
            everybodys + jobs > settings.max_queued_jobs,
            "queue_full",
            f"{everybodys} jobs wait here already: submit again when some have ended.",
            _RETRY_S,
        ),
        (
            callers + jobs > settings.key_max_queued_jobs,
            "too_many_jobs",
            f"You may have {settings.key_max_queued_jobs} unfinished jobs: submit again when some have ended.",
            _RETRY_S,
        ),
    ]
    if settings.key_upload_bytes_per_hour is not None:
        most, uploaded = settings.key_upload_bytes_per_hour, context.quota.uploaded(caller.owner)
        policies.append(f'"upload";q={most};qu="content-bytes";w={WINDOW_S}')
        left.append(f'"upload";r={max(0, most - uploaded.size_bytes - declared_bytes)};t={uploaded.ends_in_s}')
        refusals.append(
            (
                uploaded.size_bytes + declared_bytes > most,
                "too_many_bytes",
                f"You may upload {most} bytes in an hour: go on in {uploaded.ends_in_s} seconds.",
                uploaded.ends_in_s,
            )
        )
    headers = {"RateLimit-Policy": ", ".join(policies), "RateLimit": ", ".join(left)}
    for applies, code, sentence, retry_s in refusals:
        if applies:
            raise Problem(code, sentence, headers={**headers, "Retry-After": str(retry_s)})
    return headers
