"""The worker process: it takes jobs from the queue and runs each in a child process, the work-horse."""

import logging
import os
import secrets
import signal
import socket
import sys
from functools import partial
from types import FrameType
from typing import Any

from rq import Worker
from rq.job import Job as Entry
from rq.serializers import JSONSerializer
from rq.worker import WorkerStatus
from rq.worker_registration import register

from cleave.logs import about, configure_logging, rename_process
from cleave.parent_death import die_with_parent
from cleave.settings import Settings, load_settings
from cleave.trace import Trace, parse_traceparent
from worker.jobs.attempts import Attempt
from worker.jobs.queue.connection import connect, connect_with_retries
from worker.jobs.queue.counters import JobCounters
from worker.jobs.queue.entries import is_valid
from worker.jobs.queue.queue import JobQueue
from worker.jobs.queue.workers import HEARTBEAT_TTL_S
from worker.jobs.queued_edit import QueuedEdit
from worker.jobs.size_class import SizeClass
from worker.jobs.store.opening import open_store
from worker.jobs.store.store import JobStore, UnknownJob
from worker.process.edit_runs import EditRuns
from worker.process.kernels import WorkerKernels
from worker.process.lease import LeaseKeeper
from worker.process.ledger import Ledger
from worker.process.perform import perform
from worker.process.progress import ProgressReporter
from worker.process.staging import StagedJob, stage
from worker.process.watch import Watch
from worker.process.work_horse import Ending, ending_of, exit_status, limit_resources, out_of_memory_kills

log = logging.getLogger("cleave.worker")

_STORE_PAUSE_S = 2.0  # before the next job if the store is full or does not answer; set by hand
_DEQUEUE_TTL_S = 20  # rq waits 15 s less than this for an entry, then sends a heartbeat and waits again


class JobWorker(Worker):  # type: ignore[misc]  # rq is not analysed
    """An rq worker that reads the state of jobs from the store instead of Redis.

    It uses rq for the registration, the dequeue through an intermediate list, the fork and the warm shutdown. The
    work-horse writes its outcome to the store and needs no Redis. Meanwhile this process renews the lease, and kills
    the work-horse if it exceeds its time, if its job gets an outcome elsewhere, or on shutdown. It takes no commands
    from Redis, and it does not import the function that an entry names.
    """

    max_connection_wait_time = 2.0  # rq's longest pause between two attempts to reach Redis

    def __init__(
        self,
        store: JobStore,
        queue: JobQueue,
        leases: JobQueue,
        settings: Settings,
        size: SizeClass,
        kernels: WorkerKernels,
    ) -> None:
        """``queue`` needs a connection that retries for minutes, ``leases`` one with a short timeout."""
        super().__init__(
            [queue.entries[size]],
            name=f"{socket.gethostname()}.{os.getpid()}.{secrets.token_hex(4)}",
            connection=queue.connection,
            serializer=JSONSerializer,
            worker_ttl=_DEQUEUE_TTL_S,
            log_job_description=False,
        )
        self._store = store
        self._queue = queue
        self._leases = leases
        self._counters = JobCounters(leases.connection)
        self._settings = settings
        self._kernels = kernels
        self._staged: StagedJob | None = None  # the job that runs
        self._lease = LeaseKeeper(leases, self.name, settings.lease_s, partial(self.heartbeat, None))
        self._ledger = Ledger(store, queue, self._counters, settings, size, self.name)
        self._watch = Watch(settings)
        self._edits = EditRuns(store, settings, self._watch)
        self._horse_exit = -1  # a descriptor that becomes readable when the work-horse has ended

    # Methods that rq calls.

    def execute_job(self, job: Entry, queue: Any) -> None:
        self.set_state(WorkerStatus.BUSY)
        if not is_valid(job):
            log.warning("an unknown entry of the queue was dropped: %r", job.id)
            self._queue.forget(job.id)
        elif self._queue.take(job.id, self.name, self._settings.lease_s):
            self._run_or_hand_back(job, queue)
        self.set_state(WorkerStatus.IDLE)
        self._kernels.load_others()

    def fork_work_horse(self, job: Entry, queue: Any) -> None:
        self._horse_exit, held_by_the_horse = os.pipe()
        super().fork_work_horse(job, queue)
        os.close(held_by_the_horse)

    def main_work_horse(self, job: Entry, queue: Any) -> None:  # noqa: ARG002
        self.setup_work_horse_signals()
        rename_process("work_horse")
        limit_resources(self._settings)
        os._exit(exit_status(lambda: self._perform(job.id)))

    def setup_work_horse_signals(self) -> None:
        """Ignore signals to the process group, which the worker handles, and die with the worker."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        die_with_parent(self.pid)

    def handle_warm_shutdown_request(self) -> None:
        self._watch.stop_within(self._settings.shutdown_grace_s)

    def request_force_stop(self, signum: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self._watch.stop_within(0.0)

    def set_shutdown_requested_date(self) -> None:
        """Do nothing, as rq writes to Redis here, which a signal handler must not wait for."""

    def heartbeat(self, timeout: int | None = None, pipeline: Any = None) -> None:  # noqa: ARG002
        super().heartbeat(HEARTBEAT_TTL_S, pipeline)
        register(self, pipeline)  # again, as Redis may have lost its data

    @property
    def should_run_maintenance_tasks(self) -> bool:
        return False  # the janitor does this

    def subscribe(self) -> None:
        """Do nothing: no commands are taken from Redis."""

    # Running one job.

    def _run_or_hand_back(self, entry: Entry, queue: Any) -> None:
        """Run a job or an edit, or requeue it if the store fails."""
        with about(entry.id) as subject:
            try:
                edit = self._store.queued_edits.waiting(entry.id)
                if edit is not None:
                    self._run_edit(edit)
                    return
                subject.trace = self._trace(entry.id)
                attempt = self._ledger.begin(entry.id)
                if attempt is not None:
                    self._attempt(entry, queue, attempt)
                self._ledger.settle(entry.id)
            except OSError as error:
                log.warning("job %s waits again, as the store failed: %s", entry.id, error)
                self._counters.store_failed("worker")
                self._watch.pause(_STORE_PAUSE_S)
                self._ledger.hand_back(entry.id)

    def _run_edit(self, edit: QueuedEdit) -> None:
        has_ended = self._edits.run(edit, on_tick=partial(self._lease.renew, edit.id))
        if not has_ended:
            self._ledger.hand_back(edit.id)
            return
        self._queue.release(edit.id, self.name)
        self._queue.forget(edit.id)

    def _trace(self, job_id: str) -> Trace | None:
        job = self._store.records.job(job_id)
        return parse_traceparent(job.traceparent) if job else None

    def _attempt(self, entry: Entry, queue: Any, attempt: Attempt) -> None:
        log.log(logging.INFO if attempt.number > 1 else logging.DEBUG, "job %s: attempt %d", entry.id, attempt.number)
        try:
            with stage(self._store, entry.id, partial(self._lease.kept, entry.id)) as self._staged:
                ending = self._run_work_horse(entry, queue)
                self._staged.publish()
            self._ledger.end(entry.id, attempt, ending)
        except UnknownJob:
            log.info("job %s was deleted", entry.id)
        except OSError:  # not the fault of the job
            self._ledger.uncount(entry.id, attempt)
            raise

    def _run_work_horse(self, entry: Entry, queue: Any) -> Ending:
        kills_before = out_of_memory_kills()
        self.fork_work_horse(entry, queue)
        stopped_for = self._watch.wait(
            self.horse_pid,
            self._horse_exit,
            has_ended=partial(self._store.records.has_ended, entry.id),
            on_tick=partial(self._lease.renew, entry.id),
        )
        _, status, usage = self.wait_for_horse()
        self._horse_pid = 0
        log.debug("job %s: the work-horse ended with %d, %d KiB", entry.id, status, usage.ru_maxrss)
        return stopped_for or ending_of(status, kills_before)

    def _perform(self, job_id: str) -> None:
        """Run the job; called in the work-horse."""
        assert self._staged, "the job is staged before the fork"
        work = perform(self._staged.store, self._settings, job_id, ProgressReporter(self._leases, job_id))
        if work is not None:
            self._counters.job_ended(work.job, work.outcome, work.stage_seconds)


def main() -> None:
    """Run a worker for the queue of the size class that is the first argument."""
    size = SizeClass(sys.argv[1])
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, "worker")
    assert settings.redis_url, "the parent process sets CLEAVE_REDIS_URL"
    queue = JobQueue(connect_with_retries(settings.redis_url))
    leases = JobQueue(connect(settings.redis_url))
    kernels = WorkerKernels(leases.connection)
    kernels.load_first()
    log.info("ready for %s jobs", size)
    JobWorker(open_store(settings), queue, leases, settings, size, kernels).work(logging_level="WARNING")
