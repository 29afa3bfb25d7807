"""The processes of an installation: how each is started."""

import os
import sys
import sysconfig
from collections.abc import Mapping
from pathlib import Path

from cleave.settings import Settings
from service.host.queue_server import QueueServer
from service.host.supervisor import Program
from worker.jobs.size_class import SizeClass

_STOP_MARGIN_S = 4.0  # to leave the queue in order when the job has ended or was handed back

# Every work-horse has one job on one core; libraries that start a thread per core would only get in each other's way.
_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def queue_server_program(server: QueueServer) -> Program:
    return Program("queue server", server.command, is_support=True)


def api_program(settings: Settings, listening: int) -> Program:
    command = _python("service.host.http_server", str(listening))
    return Program("service", command, _environment(settings), descriptors=(listening,))


def worker_programs(settings: Settings, counts: Mapping[SizeClass, int]) -> list[Program]:
    """The workers, the janitor without which a lost job would stay lost, and the courier who tells the webhooks."""
    environment = _environment(settings)
    threads = {name: os.environ.get(name, value) for name, value in _ONE_THREAD.items()}
    grace_s = settings.shutdown_grace_s + _STOP_MARGIN_S
    workers = [
        Program(
            f"worker {number} for {size} jobs", _python("worker.process", size), environment | threads, grace_s=grace_s
        )
        for size, count in counts.items()
        for number in range(1, count + 1)
    ]
    janitor = Program("janitor", _python("worker.janitor"), environment)
    return [*workers, janitor, Program("courier", _python("worker.webhooks"), environment)]


def _python(module: str, *arguments: str) -> list[str]:
    return [sys.executable, "-P", "-m", module, *arguments]


def _environment(settings: Settings) -> dict[str, str]:
    """The settings as they were resolved here, and where the modules are."""
    assert settings.redis_url, "the queue server is known by now"
    environment = {"CLEAVE_DATA_DIR": str(settings.data_dir), "CLEAVE_REDIS_URL": settings.redis_url}
    root = Path(__file__).parents[2]
    if root != Path(sysconfig.get_path("purelib")):  # a checkout: -P keeps the working folder off the path
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, [str(root), os.environ.get("PYTHONPATH")]))
    return environment
