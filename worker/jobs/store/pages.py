"""Pages of the list of an owner's jobs."""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from worker.jobs.job import Job
from worker.jobs.store.index import JobIndex, is_entry_name, job_id_of
from worker.jobs.store.layout import TIME_FORMAT, entry_name
from worker.jobs.store.records import Records

_GRACE = timedelta(hours=1)  # the job of a younger entry may still be uploaded to the store; set by hand


@dataclass(frozen=True, slots=True)
class JobPage:
    """Consecutive jobs of an owner, newest first."""

    jobs: list[Job]
    next_cursor: str | None  # of the next page; None if there are no older jobs


def read_page(index: JobIndex, records: Records, owner: str | None, cursor: str | None, limit: int) -> JobPage:
    """Return the jobs from a cursor on, and remove entries whose job was never accepted or was deleted."""
    entries = index.page(owner, cursor, limit + 1)
    shown = [entry for entry in entries[:limit] if is_entry_name(entry)]
    by_id = records.jobs([job_id_of(entry) for entry in shown])
    found = {entry: by_id[job_id_of(entry)] for entry in shown}
    oldest = f"{datetime.now(UTC) - _GRACE:{TIME_FORMAT}}"
    for entry in (entry for entry, job in found.items() if job is None and entry < oldest):
        index.remove_entry(owner, entry)
    jobs = [job for entry, job in found.items() if job is not None and entry_name(job) == entry]
    return JobPage(jobs, entries[limit - 1] if len(entries) > limit else None)
