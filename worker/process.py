"""The process that takes jobs from the queue and runs each in a child process, the work-horse."""

import logging
import os
import secrets
import select
import signal
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from threading import Event, Thread
from types import FrameType
from typing import Any

from rq import Worker
from rq.exceptions import DeserializationError
from rq.job import Job as Entry
from rq.serializers import JSONSerializer
from rq.worker import WorkerStatus
from rq.worker_registration import register

import segcore
from worker.admission import admit
from worker.jobs import Attempt, Cause, exhausted, is_job_id
from worker.logs import about, configure_logging, rename_process
from worker.opening import open_store
from worker.parent_death import die_with_parent
from worker.progress import ProgressReporter
from worker.queue import TASK, JobQueue, QueueError, connect_impatiently, connect_patiently
from worker.settings import Settings, load_settings
from worker.size_class import SizeClass
from worker.staging import Desk, desk_for
from worker.store import JobStore, UnknownJob
from worker.tallies import Tallies
from worker.tasks import perform
from worker.work_horse import cannot_store, cause_of_death, exit_status, limit_memory, out_of_memory_kills

log = logging.getLogger("cleave.worker")

_TICK_S = 1.0  # how often a running job is looked at
_REGISTERED_S = 30  # how long a worker counts as alive after its last sign of life
_STORE_PAUSE_S = 2.0  # after the store was full or did not answer
_DEQUEUE_TTL_S = 20  # rq blocks for 15 s less, and gives a sign of life in between


class JobWorker(Worker):  # type: ignore[misc]  # rq is not analysed
    """An rq worker for which the store, not Redis, says what has become of a job.

    rq's part is the registration, the dequeue with its intermediate list, the fork and the warm shutdown. The
    work-horse writes its outcome to the store and needs no Redis; this process renews the lease meanwhile, and stops a
    work-horse that overruns, or whose job got an outcome elsewhere, or that would hold up a shutdown. It takes no
    commands from Redis, and the one function that it runs is not looked up by the name in the entry.
    """

    max_connection_wait_time = 2.0

    def __init__(self, store: JobStore, queue: JobQueue, leases: JobQueue, settings: Settings, size: SizeClass) -> None:
        """``queue`` may wait for Redis as long as it takes, ``leases`` must not."""
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
        self._tallies = Tallies(leases.connection)
        self._settings = settings
        self._size = size
        self._desk: Desk | None = None  # of the job that runs
        self._uncounted: list[tuple[str, Attempt]] = []  # attempts that the store would not withdraw yet
        self._stop_by = float("inf")  # when a running job is handed back, on the monotonic clock
        self._horse_is_gone = -1  # a descriptor that becomes readable

    # What rq calls.

    def execute_job(self, job: Entry, queue: Any) -> None:
        self.set_state(WorkerStatus.BUSY)
        if not is_allowed(job):
            log.warning("an entry of the queue that is not a job of this installation was dropped: %r", job.id)
            self._queue.forget(job.id)
        elif self._queue.take(job.id, self.name, self._settings.lease_s):
            try:
                with about(job.id, self._traceparent(job.id)):
                    self._run_if_open(job, queue)
                    self._settle(job.id)
            except OSError as error:
                self._hand_back(job.id, error)
        self.set_state(WorkerStatus.IDLE)

    def fork_work_horse(self, job: Entry, queue: Any) -> None:
        self._horse_is_gone, held_by_the_horse = os.pipe()
        super().fork_work_horse(job, queue)
        os.close(held_by_the_horse)

    def main_work_horse(self, job: Entry, queue: Any) -> None:  # noqa: ARG002
        self.setup_work_horse_signals()
        rename_process("work_horse")
        limit_memory(self._settings.job_memory_bytes)
        os._exit(exit_status(lambda: self._perform(job.id)))

    def setup_work_horse_signals(self) -> None:
        """A signal to the whole group is for the worker to decide about; its death is the end of the work-horse."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        die_with_parent(self.pid)

    def handle_work_horse_killed(self, job: Entry, retpid: int, ret_val: int, rusage: Any) -> None:
        log.warning("the work-horse %d of job %s ended with %d, %d KiB", retpid, job.id, ret_val, rusage.ru_maxrss)

    def handle_warm_shutdown_request(self) -> None:
        self._stop_by = time.monotonic() + self._settings.shutdown_grace_s

    def request_force_stop(self, signum: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self._stop_by = 0.0

    def set_shutdown_requested_date(self) -> None:
        """Nothing: a signal handler does not wait for Redis."""

    def heartbeat(self, timeout: int | None = None, pipeline: Any = None) -> None:  # noqa: ARG002
        super().heartbeat(_REGISTERED_S, pipeline)
        register(self, pipeline)  # Redis may have been wiped since the last time

    @property
    def should_run_maintenance_tasks(self) -> bool:
        return False  # the janitor's

    def subscribe(self) -> None:
        """No commands from Redis."""

    # One job.

    def _perform(self, job_id: str) -> None:
        assert self._desk, "it was laid out before the fork"
        work = perform(self._desk.store, self._settings, job_id, ProgressReporter(self._leases, job_id))
        if work is not None:
            self._tallies.job_ended(work.job, work.outcome, work.stage_seconds)

    def _traceparent(self, job_id: str) -> str | None:
        job = self._store.job(job_id)
        return job.traceparent if job else None

    def _run_if_open(self, entry: Entry, queue: Any) -> None:
        if self._store.job(entry.id) is None:
            log.warning("job %s is not in the store: it was deleted, or CLEAVE_DATA_DIR is another's", entry.id)
        if not self._is_open(entry.id):
            return
        self._withdraw_uncounted()
        failed = exhausted(self._store.attempts(entry.id), self._settings.max_attempts)
        try:
            if failed is not None:
                self._store.finish(entry.id, failed)
                self._tallies.job_given_up(failed.code)
            else:
                self._attempt(entry, queue, self._store.begin_attempt(entry.id, self.name))
        except UnknownJob:
            log.info("job %s was deleted", entry.id)

    def _attempt(self, entry: Entry, queue: Any, attempt: Attempt) -> None:
        log.info("job %s: attempt %d", entry.id, attempt.number)
        try:
            with ExitStack() as stack:
                with self._keeping_the_lease(entry.id):
                    self._desk = stack.enter_context(desk_for(self._store, entry.id))
                self._run(entry, queue, attempt)
        except OSError:  # through no fault of the job
            self._uncounted.append((entry.id, attempt))
            raise

    def _run(self, entry: Entry, queue: Any, attempt: Attempt) -> None:
        assert self._desk, "the job is laid out"
        kills_before = out_of_memory_kills()
        self.fork_work_horse(entry, queue)
        stopped_for = self._watch(entry.id)
        pid, status, usage = self.wait_for_horse()
        self._horse_pid = 0
        with self._keeping_the_lease(entry.id):
            self._desk.publish()
        if not self._is_open(entry.id):
            return
        if stopped_for == "shutdown":
            self._store.withdraw_attempt(entry.id, attempt)
            return
        if cannot_store(status):
            raise OSError("what the work-horse wrote could not be stored")
        self.handle_work_horse_killed(entry, pid, status, usage)
        cause: Cause = "timed_out" if stopped_for == "timeout" else cause_of_death(status, kills_before)
        self._tallies.attempt_lost(cause)
        self._store.end_attempt(entry.id, attempt, cause)

    def _watch(self, job_id: str) -> str | None:
        """Wait for the end of the work-horse; why it had to be stopped, None where it ended by itself."""
        ends_at = time.monotonic() + self._settings.job_timeout_s
        stopped_for = None
        while not select.select([self._horse_is_gone], [], [], _TICK_S)[0]:
            self._renew_lease(job_id)
            stopped_for = stopped_for or self._reason_to_stop(job_id, ends_at)
            if stopped_for:
                os.kill(self.horse_pid, signal.SIGKILL)
        os.close(self._horse_is_gone)
        return stopped_for

    def _reason_to_stop(self, job_id: str, ends_at: float) -> str | None:
        with suppress(OSError):  # a store that does not answer now may do so when the work is done
            if not self._is_open(job_id):
                return "canceled"
        if time.monotonic() > ends_at:
            return "timeout"
        return "shutdown" if time.monotonic() > self._stop_by else None

    def _renew_lease(self, job_id: str) -> None:
        try:
            self._leases.renew(job_id, self.name, self._settings.lease_s)
            with self._leases.connection.pipeline() as pipeline:
                self.heartbeat(pipeline=pipeline)
                pipeline.execute()
        except QueueError as error:
            log.warning("the lease of job %s was not renewed: %s", job_id, error)

    @contextmanager
    def _keeping_the_lease(self, job_id: str) -> Iterator[None]:
        """Renew the lease from a thread while this one waits for a store that is not of this machine."""
        has_ended = Event()

        def renew() -> None:
            while not has_ended.wait(_TICK_S):
                self._renew_lease(job_id)

        thread = Thread(target=renew, daemon=True)
        if not self._store.is_local:
            thread.start()
        try:
            yield
        finally:
            has_ended.set()
            if thread.ident:
                thread.join()

    def _hand_back(self, job_id: str, error: OSError) -> None:
        """Leave a job that the store keeps from being done to the next worker, or to this one in a moment."""
        log.warning("job %s waits again: %s", job_id, error)
        with suppress(OSError):  # before the next attempt it is tried again
            self._withdraw_uncounted()
        time.sleep(max(0.0, min(_STORE_PAUSE_S, self._stop_by - time.monotonic())))
        self._queue.release(job_id, self.name)
        self._queue.requeue(job_id, self._size)

    def _withdraw_uncounted(self) -> None:
        while self._uncounted:
            self._store.withdraw_attempt(*self._uncounted[-1])
            self._uncounted.pop()

    def _settle(self, job_id: str) -> None:
        """Leave the queue as the store says: nothing of a job that has ended, another entry for one that has not."""
        outcome = self._store.outcome(job_id)
        log.info("job %s: %s", job_id, outcome.status if outcome else "no outcome")
        self._queue.release(job_id, self.name)
        if self._is_open(job_id):
            self._queue.requeue(job_id, self._size, at_front=True)
        else:
            self._queue.forget(job_id)
            self._admit_next(job_id)

    def _admit_next(self, job_id: str) -> None:
        """The owner of a job that has ended may have another in the queue."""
        job = self._store.job(job_id)
        if job is not None:
            admit(self._store, self._queue, self._settings, job.owner)

    def _is_open(self, job_id: str) -> bool:
        return self._store.job(job_id) is not None and self._store.outcome(job_id) is None


def is_allowed(entry: Entry) -> bool:
    """Whether an entry is what JobQueue.enqueue makes; whoever can write to Redis can make others."""
    try:
        return (
            is_job_id(entry.id)
            and (entry.func_name, entry.instance) == (TASK, None)
            and (list(entry.args), dict(entry.kwargs)) == ([entry.id], {})
        )
    except (DeserializationError, TypeError, ValueError):
        return False


def main() -> None:
    """Work for the queue whose size class is the first argument."""
    size = SizeClass(sys.argv[1])
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, "worker")
    assert settings.redis_url, "the parent process sets CLEAVE_REDIS_URL"
    log.info("loading the kernels; the first time they are compiled, which takes up to a minute")
    segcore.warm_up()
    log.info("ready for %s jobs", size)
    queue = JobQueue(connect_patiently(settings.redis_url))
    leases = JobQueue(connect_impatiently(settings.redis_url))
    JobWorker(open_store(settings), queue, leases, settings, size).work(logging_level="WARNING")


if __name__ == "__main__":
    main()
