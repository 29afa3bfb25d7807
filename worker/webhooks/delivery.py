"""The process that delivers webhooks: it sends each message again, with growing pauses, until it is accepted."""

import logging
import os
import signal
import socket
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import UTC, datetime
from threading import Event

from cleave.logs import about, configure_logging
from cleave.settings import Settings, load_settings
from worker.jobs.job import Job, Outcome
from worker.jobs.queue.connection import QueueError, connect
from worker.jobs.queue.locks import Locks
from worker.jobs.store.installation_secret import InstallationSecret
from worker.jobs.store.opening import open_store
from worker.jobs.store.outbox import Delivery
from worker.jobs.store.store import JobStore
from worker.webhooks.message import Undeliverable, send, webhook_body

_LOGGED_AS = "courier"  # the process in the log, as docs/operations.md lists it

log = logging.getLogger(f"cleave.{_LOGGED_AS}")

# Pauses after the first failure, the second, ...; after one more the delivery is given up. They are those of Svix, the
# authors of Standard Webhooks, with one more after 30 s and without the second one of 10 h.
BACK_OFF_S = (5.0, 30.0, 300.0, 1800.0, 7200.0, 18_000.0, 36_000.0)
_POLL_S = 0.5  # the longest delay of a message; set by hand
_LOCK_S = 60.0  # longer than a delivery takes, which times out after 10 s without progress
_THREADS = 8  # concurrent deliveries, so that a slow receiver does not delay the others; set by hand
_WITHOUT_JOB_S = 600.0  # an upload to the store is over by then


@dataclass(frozen=True, slots=True)
class WebhookSender:
    store: JobStore
    locks: Locks
    settings: Settings
    name: str  # of this process, unique in the installation
    stop: Event = field(default_factory=Event)  # if it is set, no further delivery begins

    def send_due(self, at_s: float) -> None:
        """Send the messages that are due at a time in seconds since 1970, each from one process of the installation."""
        undelivered = self.store.outbox.job_ids()
        unfinished = self.store.pending.ids() if undelivered else set()
        deliveries = self.store.outbox.deliveries(undelivered - unfinished)
        due = [job_id for job_id, delivery in deliveries.items() if delivery.due_at <= at_s]
        with ThreadPoolExecutor(_THREADS) as pool:
            list(pool.map(lambda job_id: self._deliver(job_id, at_s), due))

    def _deliver(self, job_id: str, at_s: float) -> None:
        if self.stop.is_set():
            return
        job, outcome = self.store.records.job(job_id), self.store.records.outcome(job_id)
        if job is None or job.webhook_url is None:
            self.store.outbox.remove_old(job_id, _WITHOUT_JOB_S)  # a new one is written a moment before its job
        elif outcome is not None and self.locks.acquire(f"webhook:{job_id}", self.name, _LOCK_S):
            delivery = self.store.outbox.delivery(job_id)  # None if another process has just delivered it
            if delivery is not None:
                with about(job_id, job.traceparent):
                    self._try(job, outcome, delivery, at_s)
            self.locks.release(f"webhook:{job_id}")

    def _try(self, job: Job, outcome: Outcome, delivery: Delivery, at_s: float) -> None:
        secret = webhook_secret(self.store.secret, job.owner)
        at = datetime.fromtimestamp(at_s, UTC)
        try:
            send(
                str(job.webhook_url),
                f"msg_{job.id}",
                secret,
                webhook_body(job, outcome, self.settings.root_path),
                at,
                self.settings.webhook_private_targets,
            )
        except Undeliverable as error:
            self._postpone(job, delivery, at_s, str(error))
            return
        log.info("the webhook was delivered")
        self.store.outbox.remove(job.id)

    def _postpone(self, job: Job, delivery: Delivery, at_s: float, reason: str) -> None:
        if delivery.failures == len(BACK_OFF_S):
            log.warning("the webhook of job %s is given up: %s", job.id, reason)
            self.store.outbox.remove(job.id)
            return
        pause_s = BACK_OFF_S[delivery.failures]
        log.info("the webhook of job %s is sent again in %.0f s: %s", job.id, pause_s, reason)
        self.store.outbox.put(job.id, Delivery(delivery.failures + 1, at_s + pause_s))


def webhook_secret(secret: InstallationSecret, owner: str | None) -> bytes:
    """Return the secret with which the webhooks of an owner are signed."""
    return secret.derive("webhook", owner or "")


def main() -> None:
    """Deliver webhooks until SIGTERM; a message that is on its way then is not sent again after the next start."""
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, _LOGGED_AS)
    logging.getLogger("httpx").setLevel(logging.WARNING)
    assert settings.redis_url, "the parent process sets CLEAVE_REDIS_URL"
    store = open_store(settings)
    sender = WebhookSender(store, Locks(connect(settings.redis_url)), settings, f"{socket.gethostname()}.{os.getpid()}")
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sender.stop.set())
    while not sender.stop.is_set():
        try:
            sender.send_due(time.time())
        except (QueueError, OSError) as error:
            log.warning("webhooks cannot be sent at the moment: %s", error)
        sender.stop.wait(max(_POLL_S, store.objects.poll_interval_s))
