"""The process that tells webhooks how their jobs have ended, again and again until they have understood."""

import logging
import os
import socket
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import UTC, datetime

from cleave.logs import about, configure_logging
from cleave.settings import Settings, load_settings
from worker.jobs.job import Job, Outcome
from worker.jobs.queue.queue import JobQueue, QueueError, connect_impatiently
from worker.jobs.store.installation_secret import InstallationSecret
from worker.jobs.store.opening import open_store
from worker.jobs.store.outbox import Letter, Outbox
from worker.jobs.store.store import JobStore
from worker.webhooks.message import Undeliverable, send, webhook_body

log = logging.getLogger("cleave.courier")

# Pauses after the first failure, the second, ...; after the last one the message is given up.
BACK_OFF_S = (5.0, 30.0, 300.0, 1800.0, 7200.0, 18_000.0, 36_000.0)
_LOOK_S = 0.5
_CLAIM_S = 60.0  # longer than one delivery can take
_AT_A_TIME = 8
_WITHOUT_JOB_S = 600.0


@dataclass(frozen=True, slots=True)
class Courier:
    store: JobStore
    outbox: Outbox
    queue: JobQueue
    secret: InstallationSecret
    settings: Settings
    name: str

    def round(self, at_s: float) -> None:
        """Deliver what is due at a time (in seconds since 1970); one courier of an installation has a letter."""
        letters = self.outbox.letters(but_of=self.store.pending.ids())
        due = [job_id for job_id, letter in letters.items() if letter.due_at <= at_s]
        with ThreadPoolExecutor(_AT_A_TIME) as pool:
            list(pool.map(lambda job_id: self._deliver(job_id, at_s), due))

    def _deliver(self, job_id: str, at_s: float) -> None:
        job, outcome = self.store.job(job_id), self.store.outcome(job_id)
        if job is None or job.webhook_url is None:
            self.outbox.remove_old(job_id, _WITHOUT_JOB_S)  # it comes a moment before its job
        elif outcome is not None and self.queue.claim(f"webhook:{job_id}", self.name, _CLAIM_S):
            letter = self.outbox.letter(job_id)  # another courier may have delivered it meanwhile
            if letter is not None:
                with about(job_id, job.traceparent):
                    self._try(job, outcome, letter, at_s)
            self.queue.give_back(f"webhook:{job_id}")

    def _try(self, job: Job, outcome: Outcome, letter: Letter, at_s: float) -> None:
        secret = webhook_secret(self.secret, job.owner)
        at = datetime.fromtimestamp(at_s, UTC)
        try:
            send(
                str(job.webhook_url),
                f"msg_{job.id}",
                secret,
                webhook_body(job, outcome),
                at,
                self.settings.webhook_private_targets,
            )
        except Undeliverable as error:
            self._postpone(job, letter, at_s, str(error))
            return
        log.info("the webhook is told")
        self.outbox.remove(job.id)

    def _postpone(self, job: Job, letter: Letter, at_s: float, reason: str) -> None:
        if letter.failures == len(BACK_OFF_S):
            log.warning("the webhook of job %s is given up: %s", job.id, reason)
            self.outbox.remove(job.id)
            return
        pause_s = BACK_OFF_S[letter.failures]
        log.info("the webhook of job %s is tried again in %.0f s: %s", job.id, pause_s, reason)
        self.outbox.put(job.id, Letter(letter.failures + 1, at_s + pause_s))


def webhook_secret(secret: InstallationSecret, owner: str | None) -> bytes:
    """What the webhooks of an owner are signed with."""
    return secret.derive("webhook", owner or "")


def main() -> None:
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, "courier")
    assert settings.redis_url, "the parent process sets CLEAVE_REDIS_URL"
    store = open_store(settings)
    courier = Courier(
        store,
        store.outbox,
        JobQueue(connect_impatiently(settings.redis_url)),
        store.secret,
        settings,
        f"{socket.gethostname()}.{os.getpid()}",
    )
    logging.getLogger("httpx").setLevel(logging.WARNING)
    while True:
        try:
            courier.round(time.time())
        except (QueueError, OSError) as error:
            log.warning("webhooks are not sent at the moment: %s", error)
        time.sleep(max(_LOOK_S, store.look_s))
