"""The script of the day: what the clients do, and what fails meanwhile."""

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.checkout import HERE, checked_out
from bench.day.checks import examine
from bench.day.expected import Upgrade, Versions
from bench.day.finding import Finding
from bench.day.member import Member
from bench.day.orders import Orders
from bench.day.proxies import NGINX, proxied
from bench.day.receiver import Receiver, receiving
from bench.day.site import WORKERS, Site
from bench.errors import BenchmarkError
from service.keys import key_digest, new_key
from worker.jobs.job import now

_NAMES = ("anna", "ben", "chloe")
_APPEARS_WITHIN_S = 180.0
_AWAY_S = 2.0  # for which the receiver of webhooks is away; less than the pause before the second attempt
# Above the short pauses of worker.webhooks.delivery, 5 s and 30 s, with which a refused message is sent again.
_TOLD_WITHIN_S = 60.0


@dataclass(frozen=True, slots=True)
class DayPlan:
    """The size of the day. The defaults were set by hand."""

    previous: str | None = None  # the commit of the version before the upgrade; None: the present version
    members: int = len(_NAMES)
    long_jobs: int = 3  # of each client that wait at the upgrade, and again when the other host is lost
    long_faces: int = 20_000
    settings: dict[str, str] = field(default_factory=dict)  # more settings of the service


@dataclass(slots=True)
class _Team:
    site: Site
    receiver: Receiver
    members: list[Member]
    plan: DayPlan

    def all(self, work: Callable[[Member], object]) -> None:
        """Let all clients do something at the same time."""
        with ThreadPoolExecutor(len(self.members)) as pool:
            list(pool.map(work, self.members))

    def statuses(self) -> list[str]:
        return [status for member in self.members for status in member.listed().values()]


def day(plan: DayPlan) -> list[Finding]:
    """Run the day and return what is found in the evening.

    Raises
    ------
    BenchmarkError
        If the day cannot be run, because a program is missing or something that the script needs does not happen.
    """
    with ExitStack() as stack:
        previous = HERE if plan.previous is None else stack.enter_context(checked_out(plan.previous))
        team = stack.enter_context(_team(plan))
        team.site.start(previous)
        _morning(team)
        upgrade = _upgrade(team)
        _afternoon(team)
        _wait_for_end(team)
        versions = stack.enter_context(Versions.opened(previous, HERE, upgrade.at, team.site.folder))
        return examine(team.site, team.members, team.receiver, upgrade, versions)


@contextmanager
def _team(plan: DayPlan) -> Iterator[_Team]:
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory(prefix="cleave-day-", ignore_cleanup_errors=True)))
        keys = {name: new_key() for name in _NAMES[: plan.members]}
        entries = ",".join(f"{name}:{key_digest(key)}" for name, key in keys.items())
        settings = {"CLEAVE_API_KEYS": entries, "CLEAVE_WEBHOOK_PRIVATE_TARGETS": "true", "CLEAVE_LOG_LEVEL": "warning"}
        site = Site(folder, settings | plan.settings)
        stack.callback(site.close)
        receiver = stack.enter_context(receiving())
        (folder / "proxy").mkdir()
        proxy = stack.enter_context(proxied(NGINX, folder / "proxy", site.url))
        members = [
            Member(name, key, proxy, receiver.url(name), Orders(place, len(keys), plan.long_faces))
            for place, (name, key) in enumerate(keys.items())
        ]
        for member in members:
            stack.callback(member.http.close)
        yield _Team(site, receiver, members, plan)


def _morning(team: _Team) -> None:
    """The version before the upgrade; the receiver of webhooks refuses the first messages."""
    team.receiver.refuses = True
    team.all(_submit_and_change)
    _until(team.receiver.has_refused, "No message arrives at the receiver of webhooks.")
    team.all(lambda member: _submit_long(member, team.plan.long_jobs))
    team.receiver.refuses = False


def _upgrade(team: _Team) -> Upgrade:
    """Stop the service while jobs wait and run, and start the present version on the same data."""
    _until(lambda: "running" in team.statuses(), "No job runs at the time of the upgrade.")
    statuses = team.statuses()
    team.site.stop()
    at = now()
    team.site.start(HERE)
    return Upgrade(at, waiting=statuses.count("queued"), running=statuses.count("running"))


def _afternoon(team: _Team) -> None:
    """The present version; the receiver of webhooks goes away for a while, and a host with workers for good."""
    team.all(_repeat)
    team.site.start_host(HERE)
    _until(lambda: team.site.workers() > WORKERS, "The other host does not start.")
    team.all(lambda member: _submit_long(member, team.plan.long_jobs))
    _until(team.site.host_is_working, "No job runs on the other host.")
    team.site.lose_host()
    with ThreadPoolExecutor(1) as beside:
        away = beside.submit(_be_away, team.receiver)
        team.all(_submit_and_change)
        away.result()
    team.site.start_host(HERE)
    team.all(_share)


def _be_away(receiver: Receiver) -> None:
    receiver.close()
    time.sleep(_AWAY_S)
    receiver.open()


def _repeat(member: Member) -> None:
    """Send all requests again whose jobs exist, those of the version before the upgrade."""
    for job in member.jobs:
        if job.key and not job.is_deleted:
            member.repeat(job)


def _submit_and_change(member: Member) -> None:
    """Submit, repeat, cancel and delete jobs, finished ones and waiting ones."""
    orders = member.orders
    first = member.submit(orders.short())
    member.repeat(first)
    batch = member.submit_batch([orders.short() for _ in range(3)])
    member.combine([first, batch[0]])
    canceled, unfinished = member.submit(orders.long()), member.submit(orders.long())
    member.cancel(canceled)
    member.repeat(canceled)
    member.delete(unfinished)
    member.delete(member.wait(batch[-1]))


def _submit_long(member: Member, count: int) -> None:
    for _ in range(count):
        member.repeat(member.submit(member.orders.long()))


def _share(member: Member) -> None:
    """Submit the same mesh three times, so that the jobs share a result, and delete two of the jobs."""
    order = member.orders.short()
    jobs = [member.wait(member.submit(order)) for _ in range(3)]
    for job in jobs[:2]:
        member.delete(job)


def _wait_for_end(team: _Team) -> None:
    """Wait until all jobs have ended and no message is due any more."""
    team.all(lambda member: [member.wait(job) for job in member.jobs if not job.is_deleted])
    outbox = team.site.data_dir / "outbox"
    kept = {job.id for member in team.members for job in member.jobs if not job.is_deleted}
    deadline = time.monotonic() + _TOLD_WITHIN_S
    while kept & {path.name for path in outbox.iterdir()} and time.monotonic() < deadline:
        time.sleep(0.1)


def _until(condition: Callable[[], bool], otherwise: str) -> None:
    deadline = time.monotonic() + _APPEARS_WITHIN_S
    while not condition():
        if time.monotonic() > deadline:
            raise BenchmarkError(otherwise)
        time.sleep(0.02)
