"""What must be true in the evening, as numbers that must be 0, and how much there was of it."""

import hashlib
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import datetime
from urllib.parse import urlsplit

from bench.day.expected import Upgrade, Versions
from bench.day.finding import Finding
from bench.day.member import ENDED, Member
from bench.day.messages import told
from bench.day.proxies import PATH
from bench.day.receiver import Receiver
from bench.day.site import Site

_RESULTS = ("", "/labels", "/hierarchy", "/model.glb", "/events", "/result.cleave")

_NOTES = {"deleted", "gone"}  # folders of the present version and of earlier ones
_REMOVED_WITHIN_S = 20.0  # enough on a busy machine


def examine(
    site: Site, members: Sequence[Member], receiver: Receiver, upgrade: Upgrade, versions: Versions
) -> list[Finding]:
    """Return all findings."""
    return [
        *_amounts(members, upgrade),
        *_jobs(members, versions),
        *told(members, receiver.messages),
        *_strangers(members),
        Finding("files left of deleted jobs", len(_remains(site, members, upgrade.at))),
        Finding("links that do not lead through the proxy", _links_astray(members, upgrade.at)),
    ]


def _amounts(members: Sequence[Member], upgrade: Upgrade) -> Iterator[Finding]:
    jobs = [job for member in members for job in member.jobs]
    amounts = {
        "clients": len(members),
        "accepted jobs": len(jobs),
        "jobs that waited at the upgrade": upgrade.waiting,
        "jobs that ran at the upgrade": upgrade.running,
        "requests that were sent again": sum(len(member.repeats) for member in members),
        "jobs that were deleted": sum(job.is_deleted for job in jobs),
        "jobs that were canceled": sum(job.ends == "canceled" for job in jobs),
    }
    return (Finding(name, count, must_be_zero=False) for name, count in amounts.items())


def _jobs(members: Sequence[Member], versions: Versions) -> Iterator[Finding]:
    counts: Counter[str] = Counter()
    for member in members:
        listed = member.listed()
        kept = [job for job in member.jobs if not job.is_deleted]
        counts["lost"] += sum(listed.get(job.id) not in ENDED for job in kept)
        counts["unasked"] += len(listed.keys() - {job.id for job in kept})
        counts["twice"] += sum(first != second for first, second in member.repeats)
        for job in kept:
            document = member.document(job)
            counts["other end"] += document["status"] != job.ends
            if document["status"] == "succeeded":
                labels = member.http.get(f"/v1/jobs/{job.id}/labels", params={"format": "raw"}).content
                expected = versions.labels(job.order, datetime.fromisoformat(document["finished_at"]))
                counts["different"] += hashlib.sha256(labels).hexdigest() != expected
    yield Finding("accepted jobs that were lost", counts["lost"])
    yield Finding("jobs in a list that must not be there", counts["unasked"])
    yield Finding("repeated requests that made a second job", counts["twice"])
    yield Finding("jobs that ended otherwise than they must", counts["other end"])
    yield Finding("results different from those of segcore", counts["different"])


def _strangers(members: Sequence[Member]) -> Iterator[Finding]:
    """Count answers from which somebody learns of a job or a batch of somebody else."""
    listed = seen = tried = 0
    with members[0].client({}) as nobody:
        for owner in members:
            jobs = [f"/v1/jobs/{job.id}{result}" for job in owner.jobs for result in _RESULTS]
            batches = [f"/v1/batches/{batch}{result}" for batch in owner.batches for result in ("", "/results.zip")]
            for path in jobs + batches:
                answers = [other.http.get(path).status_code == 404 for other in members if other is not owner]
                answers.append(nobody.get(path).status_code == 401)
                tried += len(answers)
                seen += answers.count(False)
            for other in members:
                others = {job.id for job in owner.jobs} if other is not owner else set()
                listed += len(other.listed().keys() & others)
                for job_id in others:
                    changes = [other.http.post(f"/v1/jobs/{job_id}/cancel"), other.http.delete(f"/v1/jobs/{job_id}")]
                    tried += len(changes)
                    seen += sum(answer.status_code != 404 for answer in changes)
    yield Finding("requests for the work of others, or without a key", tried, must_be_zero=False)
    yield Finding("of them answered otherwise than with 404 or 401", seen)
    yield Finding("jobs in the list of another client", listed)


def _remains(site: Site, members: Sequence[Member], upgraded_at: datetime) -> list[str]:
    """Return the files of deleted jobs, except for the note that they were deleted.

    A job that ran when it was deleted may have files until its work-horse has ended. Versions before the present one
    left the message of a deleted job in the outbox for ten minutes.
    """
    latest = time.monotonic() + _REMOVED_WITHIN_S
    while True:
        left = _present_remains(site, members, upgraded_at)
        if not left or time.monotonic() > latest:
            return left
        time.sleep(0.5)


def _present_remains(site: Site, members: Sequence[Member], upgraded_at: datetime) -> list[str]:
    deleted = {job.id: job.deleted_at for member in members for job in member.jobs if job.deleted_at}
    left = [path for path in site.data_dir.rglob("*") if path.is_file() and not _NOTES & {*path.parts}]
    return [
        str(path)
        for path in left
        for job_id, deleted_at in deleted.items()
        if job_id in str(path) and not (deleted_at < upgraded_at and path.parent.name == "outbox")
    ]


def _links_astray(members: Sequence[Member], upgraded_at: datetime) -> int:
    """Count links of finished jobs, and of the answers since the upgrade, that do not lead through the proxy."""
    wrong = 0
    for member in members:
        root = str(member.http.base_url).rstrip("/").removesuffix(PATH)
        for job in member.jobs:
            if job.is_deleted:
                continue
            document = member.document(job)
            if datetime.fromisoformat(document["created_at"]) > upgraded_at:
                wrong += not urlsplit(job.location).path.startswith(f"{PATH}/v1/")
            wrong += member.http.get(root + document["links"]["self"]).status_code != 200
    return wrong
