"""Builds the image without a container engine, runs it as its user on a read-only root, and segments a mesh.

    python -m deploy.image_check BASE

BASE is the root of a Debian system with Python, which replaces the base image of the Dockerfile; `make image-check`
creates one. The check must be run as root. Nothing stays mounted afterwards.
"""

import argparse
import http.client
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from deploy.image_build import Builder, BuiltStage
from segcore.io import write_mesh
from segcore.shapes import burr

_WORK = "CLEAVE_IMAGE_CHECK_WORK"
_START_S, _STOP_S = 120.0, 30.0  # as in tests/helpers/installation.py; stop_grace_period of docker-compose.yml
_PORT = 8000


def main() -> int:
    choices = _parser().parse_args()
    if _WORK not in os.environ:
        return _run_isolated(choices.work)
    context, work = Path(__file__).parent.parent, Path(os.environ[_WORK])
    variables = {name: value for name, value in os.environ.items() if name.startswith("PIP_") or "CERT" in name}
    check(Builder(context, choices.base, work, tuple(choices.bind), variables, _say).build())
    return 0


def check(image: BuiltStage) -> None:
    """Start the command of the image and send requests to it.

    Raises
    ------
    AssertionError
        If the image does not work.
    """
    user, _, group = image.user.partition(":")
    volume = {image.stage.last("VOLUME").text: f"mode=700,uid={user},gid={group}"}
    image.root.make_read_only({"/tmp": "mode=1777", **volume})
    entry = image.stage.last("ENTRYPOINT").words()
    printed = image.root.run([*entry, "key", "check"], image.environment, user=image.user)
    key, digest = (line.split()[1] for line in printed.splitlines()[:2])
    environment = {**image.environment, "CLEAVE_API_KEYS": digest}
    command = [*entry, *image.stage.last("CMD").words()]
    began_at = time.monotonic()
    with subprocess.Popen(image.root.command(command, environment, user=image.user)) as process:
        try:
            _wait_until_ready(process)
            _say(f"ready after {time.monotonic() - began_at:.1f} s")
            _use(image, process, key)
            _run_checks(image, environment)
        finally:
            process.send_signal(signal.SIGTERM)
            status = process.wait(_STOP_S)
    assert status == 0, f"SIGTERM: exit status {status}"
    _say("stopped by SIGTERM with exit status 0")


def _use(image: BuiltStage, process: "subprocess.Popen[bytes]", key: str) -> None:
    owner = Path(f"/proc/{process.pid}").stat().st_uid
    assert f"{owner}:" in image.user, f"it runs as user {owner}"
    written = subprocess.run(image.root.command(["touch", "/opt/cleave/new"], image.environment), check=False)
    assert written.returncode != 0, "root can write to the image"
    *_, health = image.stage.last("HEALTHCHECK").text.partition("CMD ")
    image.root.run(json.loads(health), image.environment, user=image.user)
    _say(f"runs as user {owner} on a read-only root, and its health check passes")
    job = _ask("POST", "/v1/jobs?format=off&segments=7", key, burr_in_off())
    assert job["status"] == "succeeded", job
    assert len(set(job["labels"])) == 7, job
    _say(f"cut a mesh of {len(job['labels'])} faces into 7 segments in one request")
    shipped = _kernels(image.root.path(image.environment["NUMBA_CACHE_DIR"]))
    used = _kernels(image.root.path(image.stage.last("VOLUME").text))
    assert used == shipped, f"kernels were compiled again: {sorted(used - shipped)}"
    _say(f"compiled no kernel: all {len(shipped)} are part of the image")


def _kernels(folder: Path) -> set[str]:
    return {f"{path.parent.name}/{path.name}" for path in folder.rglob("*.nbi")}


def _run_checks(image: BuiltStage, environment: dict[str, str]) -> None:
    """Run the health check of a worker, and cleave doctor."""
    entry = image.stage.last("ENTRYPOINT").words()
    queue = f"unix://{image.stage.last('VOLUME').text}/queue/queue.sock"
    _say(image.root.run([*entry, "worker", "--check", "--redis-url", queue], environment, user=image.user).strip())
    _say(image.root.run([*entry, "doctor", "--host", "0.0.0.0"], environment, user=image.user).strip())


def burr_in_off() -> bytes:
    """Return a ball with six arms as an OFF file."""
    target = io.BytesIO()
    write_mesh(target, burr().mesh, "off")
    return target.getvalue()


def _wait_until_ready(process: "subprocess.Popen[bytes]") -> None:
    deadline = time.monotonic() + _START_S
    while True:
        assert process.poll() is None, f"it ended with {process.returncode}"
        assert time.monotonic() < deadline, "it did not become ready"
        try:
            if _ask("GET", "/readyz")["ready"]:
                return
        except OSError:
            pass
        time.sleep(0.2)


def _ask(method: str, path: str, key: str = "", body: bytes | None = None) -> dict[str, Any]:
    connection = http.client.HTTPConnection("127.0.0.1", _PORT, timeout=90)
    try:
        connection.request(method, path, body, {"Authorization": f"Bearer {key}", "Prefer": "wait=60"})
        document: dict[str, Any] = json.load(connection.getresponse())
        return document
    finally:
        connection.close()


def _run_isolated(folder: Path | None) -> int:
    """Run this module in its own mount and process namespaces, and remove its files when they have ended."""
    own = ["unshare", "--mount", "--propagation", "private", "--pid", "--fork", "--kill-child", "--mount-proc"]
    command = [*own, sys.executable, "-m", "deploy.image_check", *sys.argv[1:]]
    work = Path(tempfile.mkdtemp(prefix="cleave-image-", dir=folder))
    status = subprocess.run(command, env={**os.environ, _WORK: str(work)}, check=False).returncode
    if str(work) in Path("/proc/self/mountinfo").read_text():
        raise RuntimeError(
            f"Something is still mounted in {work}: the folder is kept, or the files of the mount would be removed."
        )
    shutil.rmtree(work)
    return status


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("base", type=Path)
    parser.add_argument("--work", type=Path, help="folder of the roots of the stages (the temporary folder)")
    parser.add_argument(
        "--bind",
        type=Path,
        action="append",
        default=[],
        help="a path of this machine that commands can read, such as /etc/pip.conf",
    )
    return parser


def _say(text: str) -> None:
    print(text, flush=True)


if __name__ == "__main__":
    sys.exit(main())
