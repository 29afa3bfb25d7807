"""`cleave doctor`: check an installation for people and scripts."""

import argparse
import os

from cleave.settings import Settings, load_settings
from service.commands.arguments import add_data_dir
from service.commands.console import say
from service.doctor.findings import Finding, as_json, as_text, has_errors, warning
from service.doctor.machine_checks import check_machine
from service.doctor.queue_checks import check_queue
from service.doctor.store_checks import check_store
from service.host.queue_server import queue_url

_SOMETHING_TO_FIX = 1  # exit status


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Check the queue server, the store, the workers and this machine against the settings, and report what to fix."
    )
    parser.add_argument("--host", default="127.0.0.1", help="the address that the service listens on (%(default)s)")
    add_data_dir(parser)
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")


def run(choices: argparse.Namespace) -> int:
    """Run every check and print the findings."""
    settings = load_settings(data_dir=choices.data_dir)
    findings = [*_check_queue(settings), *check_store(settings), *check_machine(settings, choices.host)]
    say(as_json(findings) if choices.json else as_text(findings))
    return _SOMETHING_TO_FIX if has_errors(findings) else 0


def _check_queue(settings: Settings) -> list[Finding]:
    url = queue_url(settings)
    if settings.redis_url is None and not os.path.exists(url.removeprefix("unix://")):
        return [
            warning(
                "queue server",
                "none is set, and no `cleave serve` runs its own here.",
                "Start `cleave serve`, or set CLEAVE_REDIS_URL.",
            )
        ]
    return check_queue(url)
