"""The messages of webhooks in the evening: one for the end of each job, to its client alone."""

import base64
from collections import Counter
from collections.abc import Iterator, Sequence

from bench.day.finding import Finding
from bench.day.member import Accepted, Member
from bench.day.receiver import Message
from worker.webhooks.message import SECRET_PREFIX, signature


def told(members: Sequence[Member], messages: Sequence[Message]) -> Iterator[Finding]:
    """Compare the messages with the jobs. That a deleted job had ended before may have been told, or not."""
    jobs = {job.id: (member, job) for member in members for job in member.jobs}
    secrets = {member.name: _secret(member) for member in members}
    accepted = [message for message in messages if message.is_accepted]
    times = Counter(message.headers["webhook-id"] for message in accepted)
    untold = {job_id for job_id, (_, job) in jobs.items() if not job.is_deleted} - {one.job_id for one in accepted}
    yield Finding("messages of webhooks that were accepted", len(accepted), must_be_zero=False)
    yield Finding("messages that were refused, and sent again", len(messages) - len(accepted), must_be_zero=False)
    yield Finding("ends of jobs that were not told", len(untold))
    yield Finding("ends of jobs that were told twice", sum(count > 1 for count in times.values()))
    yield Finding("messages of another end, or to another client", sum(_is_astray(one, jobs) for one in messages))
    yield Finding("messages with another signature", sum(not _is_signed(one, secrets) for one in messages))


def _is_astray(message: Message, jobs: dict[str, tuple[Member, Accepted]]) -> bool:
    if message.job_id not in jobs:
        return True
    member, job = jobs[message.job_id]
    return message.path != f"/{member.name}" or (message.status != job.ends and not job.is_deleted)


def _is_signed(message: Message, secrets: dict[str, bytes]) -> bool:
    """Whether the signature is that of the client to which the message came."""
    headers = message.headers
    secret = secrets[message.path.removeprefix("/")]
    expected = signature(secret, headers["webhook-id"], int(headers["webhook-timestamp"]), message.body)
    return headers["webhook-signature"] == expected


def _secret(member: Member) -> bytes:
    shown = str(member.http.get("/v1/webhooks/secret").json()["secret"])
    return base64.b64decode(shown.removeprefix(SECRET_PREFIX))
