"""Limits of a caller, and the headers that report them (draft-ietf-httpapi-ratelimit-headers-10)."""

from service.context import Context
from service.guard.callers import Caller
from service.problems import Problem
from worker.jobs.queue.quota import WINDOW_S

_RETRY_S = 5  # set by hand: a job may have ended by then


def check_limits(context: Context, caller: Caller, jobs: int, declared_bytes: int) -> dict[str, str]:
    """Check that a caller may submit some jobs, and return the RateLimit headers of the response.

    Raises
    ------
    Problem
        If that exceeds a limit of the caller or of the installation.
    """
    settings = context.settings
    total, own = context.store.pending.count(caller.owner)
    policies = [f'"jobs";q={settings.key_max_queued_jobs}']
    remaining = [f'"jobs";r={max(0, settings.key_max_queued_jobs - own - jobs)}']
    refusals: list[tuple[bool, str, str, int]] = [
        (
            total + jobs > settings.max_queued_jobs,
            "queue_full",
            f"{total} jobs are waiting already: submit again when some have ended.",
            _RETRY_S,
        ),
        (
            own + jobs > settings.key_max_queued_jobs,
            "too_many_jobs",
            f"You may have {settings.key_max_queued_jobs} unfinished jobs: submit again when some have ended.",
            _RETRY_S,
        ),
    ]
    if settings.key_upload_bytes_per_hour is not None:
        limit, uploaded = settings.key_upload_bytes_per_hour, context.quota.uploaded(caller.owner)
        policies.append(f'"upload";q={limit};qu="content-bytes";w={WINDOW_S}')
        remaining.append(f'"upload";r={max(0, limit - uploaded.size_bytes - declared_bytes)};t={uploaded.ends_in_s}')
        refusals.append(
            (
                uploaded.size_bytes + declared_bytes > limit,
                "too_many_bytes",
                f"You may upload {limit} bytes in an hour: continue in {uploaded.ends_in_s} seconds.",
                uploaded.ends_in_s,
            )
        )
    headers = {"RateLimit-Policy": ", ".join(policies), "RateLimit": ", ".join(remaining)}
    for applies, code, detail, retry_s in refusals:
        if applies:
            raise Problem(code, detail, headers={**headers, "Retry-After": str(retry_s)})
    return headers
