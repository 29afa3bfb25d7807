"""Limits of a caller, and the headers that report them (draft-ietf-httpapi-ratelimit-headers-10)."""

from dataclasses import dataclass

from service.context import Context
from service.guard.callers import Caller
from service.problems import Problem
from worker.jobs.queue.quota import WINDOW_S

_RETRY_S = 5  # set by hand: a job may have ended by then


@dataclass(frozen=True, slots=True)
class _Limit:
    """A limit and the problem of a request that exceeds it."""

    is_exceeded: bool
    code: str
    detail: str
    retry_s: int
    policy: str | None = None  # the part of RateLimit-Policy
    remaining: str | None = None  # the part of RateLimit


def check_limits(context: Context, caller: Caller, jobs: int, declared_bytes: int) -> dict[str, str]:
    """Check that a caller may submit some jobs, and return the RateLimit headers of the response.

    Raises
    ------
    Problem
        If that exceeds a limit of the caller or of the installation.
    """
    limits = [*_job_limits(context, caller, jobs), *_upload_limits(context, caller, declared_bytes)]
    headers = {
        "RateLimit-Policy": ", ".join(limit.policy for limit in limits if limit.policy),
        "RateLimit": ", ".join(limit.remaining for limit in limits if limit.remaining),
    }
    for limit in limits:
        if limit.is_exceeded:
            raise Problem(limit.code, limit.detail, headers={**headers, "Retry-After": str(limit.retry_s)})
    return headers


def _job_limits(context: Context, caller: Caller, jobs: int) -> list[_Limit]:
    settings = context.settings
    total, own = context.store.pending.count(caller.owner)
    return [
        _Limit(
            total + jobs > settings.max_queued_jobs,
            "queue_full",
            f"{total} jobs are waiting already: submit again when some have ended.",
            _RETRY_S,
        ),
        _Limit(
            own + jobs > settings.key_max_queued_jobs,
            "too_many_jobs",
            f"You may have {settings.key_max_queued_jobs} unfinished jobs: submit again when some have ended.",
            _RETRY_S,
            policy=f'"jobs";q={settings.key_max_queued_jobs}',
            remaining=f'"jobs";r={max(0, settings.key_max_queued_jobs - own - jobs)}',
        ),
    ]


def _upload_limits(context: Context, caller: Caller, declared_bytes: int) -> list[_Limit]:
    limit = context.settings.key_upload_bytes_per_hour
    if limit is None:
        return []
    uploaded = context.quota.uploaded(caller.owner)
    remaining = limit - uploaded.size_bytes - declared_bytes
    return [
        _Limit(
            remaining < 0,
            "too_many_bytes",
            f"You may upload {limit} bytes in an hour: continue in {uploaded.ends_in_s} seconds.",
            uploaded.ends_in_s,
            policy=f'"upload";q={limit};qu="content-bytes";w={WINDOW_S}',
            remaining=f'"upload";r={max(0, remaining)};t={uploaded.ends_in_s}',
        )
    ]
