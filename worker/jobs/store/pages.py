"""The jobs of an owner, some at a time."""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from worker.jobs.job import Job
from worker.jobs.store.index import JobIndex, is_entry_name, job_id_of
from worker.jobs.store.layout import TIME_FORMAT, entry_name
from worker.jobs.store.records import Records

_ON_ITS_WAY = timedelta(hours=1)  # an entry without a job may be of one that is about to come


@dataclass(frozen=True, slots=True)
class JobPage:
    """Some jobs of an owner, newest first."""

    jobs: list[Job]
    next_cursor: str | None  # of the jobs that are older; None: there are none


def read_page(index: JobIndex, records: Records, owner: str | None, cursor: str | None, limit: int) -> JobPage:
    """The jobs from a cursor on; entries that have lost their job are removed."""
    entries = index.page(owner, cursor, limit + 1)
    shown = [entry for entry in entries[:limit] if is_entry_name(entry)]
    by_id = records.jobs([job_id_of(entry) for entry in shown])
    found = {entry: by_id[job_id_of(entry)] for entry in shown}
    oldest = f"{datetime.now(UTC) - _ON_ITS_WAY:{TIME_FORMAT}}"
    for entry in (entry for entry, job in found.items() if job is None and entry < oldest):
        index.remove_entry(owner, entry)
    jobs = [job for entry, job in found.items() if job is not None and entry_name(job) == entry]
    return JobPage(jobs, entries[limit - 1] if len(entries) > limit else None)
