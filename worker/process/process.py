"""The worker process: it takes jobs from the queue and runs each in a child process, the work-horse."""

import gc
import logging
import os
import secrets
import signal
import socket
import sys
import time
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any

from rq import Worker
from rq.job import Job as Entry
from rq.serializers import JSONSerializer
from rq.worker import WorkerStatus
from rq.worker_registration import register

import segcore
from cleave.logs import about, configure_logging, current_traceparent, rename_process
from cleave.parent_death import die_with_parent
from cleave.settings import Settings, load_settings
from cleave.trace import Trace, parse_traceparent
from segcore.kernels import SEGMENT
from worker.jobs.attempts import Attempt
from worker.jobs.queue.connection import QueueError, close_inherited, connect, connect_with_retries
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
from worker.process.progress import ProgressPublisher, ProgressReports
from worker.process.spare import Order, SpareWorkHorse
from worker.process.staging import stage, staged_store
from worker.process.watch import Watch
from worker.process.work_horse import Ending, ending_of, limit_resources, out_of_memory_kills

log = logging.getLogger("cleave.worker")

_STORE_PAUSE_S = 2.0  # before the next job if the store is full or does not answer; set by hand
_NICENESS = 5  # added to that of work-horses: requests are answered first if all cores segment; set by hand
_HEARTBEAT_S = 1.0  # between two; rq would send five for each job
_DEQUEUE_TTL_S = 20  # rq waits 15 s less than this for an entry, then sends a heartbeat and waits again


class JobWorker(Worker):  # type: ignore[misc]  # rq is not analysed
    """An rq worker that reads the state of jobs from the store instead of Redis.

    It uses rq for the registration, the dequeue through an intermediate list and the warm shutdown. The work-horse is
    forked before its job arrives, writes its outcome to the store and needs no Redis. Meanwhile this process renews the
    lease, and kills the work-horse if it exceeds its time, if its job gets an outcome elsewhere, or on shutdown. It
    takes no commands from Redis, and it does not import the function that an entry names.
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
        self._lease = LeaseKeeper(leases, self.name, settings.lease_s, partial(self.heartbeat, None))
        self._ledger = Ledger(store, queue, self._counters, settings, size, self.name)
        self._watch = Watch(settings)
        self._edits = EditRuns(store, settings, self._watch)
        self._spare = SpareWorkHorse(self._begin_work_horse, self._prepare_work_horse, self._perform)
        self._heartbeat_due_at = 0.0  # on the monotonic clock

    # Methods that rq calls.

    def execute_job(self, job: Entry, queue: Any) -> None:  # noqa: ARG002
        self.set_state(WorkerStatus.BUSY)
        if not is_valid(job):
            log.warning("an unknown entry of the queue was dropped: %r", job.id)
            self._queue.forget(job.id)
        elif self._queue.take(job.id, self.name, self._settings.lease_s):
            self._run_or_hand_back(job.id)
            if self._kernels.load_others():
                self._spare.dismiss()
            self._spare.fork_ahead()
        self.set_state(WorkerStatus.IDLE)

    def _install_signal_handlers(self) -> None:
        """Begin to stop in order at a signal; from then on there is a spare work-horse."""
        super()._install_signal_handlers()
        gc.collect()
        gc.freeze()  # a collection in a work-horse would otherwise copy the pages of all objects
        self._spare.fork_ahead()

    def teardown(self) -> None:
        self._spare.dismiss()
        super().teardown()

    def handle_warm_shutdown_request(self) -> None:
        self._watch.stop_within(self._settings.shutdown_grace_s)

    def request_force_stop(self, signum: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self._watch.stop_within(0.0)

    def set_shutdown_requested_date(self) -> None:
        """Do nothing, as rq writes to Redis here, which a signal handler must not wait for."""

    def heartbeat(self, timeout: int | None = None, pipeline: Any = None) -> None:  # noqa: ARG002
        if pipeline is None:
            if time.monotonic() >= self._heartbeat_due_at:
                with self.connection.pipeline() as pipeline:
                    self.heartbeat(None, pipeline)
                    pipeline.execute()
            return
        super().heartbeat(HEARTBEAT_TTL_S, pipeline)
        register(self, pipeline)  # again, as Redis may have lost its data
        self._heartbeat_due_at = time.monotonic() + _HEARTBEAT_S

    @property
    def should_run_maintenance_tasks(self) -> bool:
        return False  # the janitor does this

    def subscribe(self) -> None:
        """Do nothing: no commands are taken from Redis."""

    # Running one job.

    def _run_or_hand_back(self, entry_id: str) -> None:
        """Run a job or an edit, or requeue it if the store fails."""
        with about(entry_id) as subject:
            try:
                edit = self._store.queued_edits.waiting(entry_id)
                if edit is not None:
                    self._run_edit(edit)
                    return
                subject.trace = self._trace(entry_id)
                attempt = self._ledger.begin(entry_id)
                if attempt is not None:
                    self._attempt(entry_id, attempt)
                self._ledger.settle(entry_id)
            except OSError as error:
                log.warning("job %s waits again, as the store failed: %s", entry_id, error)
                self._counters.store_failed("worker")
                self._watch.pause(_STORE_PAUSE_S)
                self._ledger.hand_back(entry_id)

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

    def _attempt(self, job_id: str, attempt: Attempt) -> None:
        log.log(logging.INFO if attempt.number > 1 else logging.DEBUG, "job %s: attempt %d", job_id, attempt.number)
        try:
            with stage(self._store, job_id, partial(self._lease.kept, job_id)) as staged:
                ending = self._run_work_horse(job_id, staged.folder)
                if staged.publish():
                    self._announce(job_id)
            self._ledger.end(job_id, attempt, ending)
        except UnknownJob:
            log.info("job %s was deleted", job_id)
        except OSError:  # not the fault of the job
            self._ledger.uncount(job_id, attempt)
            raise

    def _run_work_horse(self, job_id: str, folder: Path | None) -> Ending:
        kills_before = out_of_memory_kills()
        work_horse = self._spare.order(Order(job_id, current_traceparent(), None if folder is None else str(folder)))
        stopped_for = self._watch.wait(
            work_horse.pid,
            work_horse.pipe,
            has_ended=partial(self._store.records.has_ended, job_id),
            on_tick=partial(self._lease.renew, job_id),
            on_reports=ProgressPublisher(self._leases, job_id),
        )
        _, status, usage = os.wait4(work_horse.pid, 0)
        log.debug("job %s: the work-horse ended with %d, %d KiB", job_id, status, usage.ru_maxrss)
        return stopped_for or ending_of(status, kills_before)

    def _announce(self, job_id: str) -> None:
        with suppress(QueueError):
            self._leases.announce_end(job_id)

    # In the work-horse.

    def _begin_work_horse(self) -> None:
        """Ignore signals to the process group, which the worker handles, die with the worker, and take the limits.

        The connections of the worker are closed here: as long as this process has them, the queue server would give
        entries to a worker that has been killed.
        """
        for queue in (self._queue, self._leases):
            close_inherited(queue.connection)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        die_with_parent(self.pid)
        rename_process("work_horse")
        os.nice(_NICENESS)
        limit_resources(self._settings)

    def _prepare_work_horse(self) -> None:
        """Connect, and segment a small mesh, which copies the pages of the worker that a job writes to.

        Without this the job only begins more slowly.
        """
        try:
            self._leases.connection.ping()  # which connects
            segcore.warm_up(SEGMENT)
        except Exception as error:
            log.debug("the spare work-horse is not prepared: %r", error)

    def _perform(self, order: Order, pipe: int) -> None:
        report = ProgressReports(pipe)
        with about(order.job_id, order.traceparent):
            if order.folder is None:
                work = perform(self._store, self._settings, order.job_id, report, partial(self._announce, order.job_id))
            else:
                work = perform(staged_store(Path(order.folder)), self._settings, order.job_id, report)
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
