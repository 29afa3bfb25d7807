"""The examples of the OpenAPI document and the API reference."""

import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import jsonschema

from helpers.api import AGAIN
from helpers.waiting import wait_until
from service.openapi.curl import EXAMPLE_ID, SERVER, command
from service.openapi.examples import body_schemas
from service.openapi.export import contract

TWO_TETRAHEDRA = b"""OFF
8 8 0
0 0 0
1 0 0
0 1 0
0 0 1
3 0 0
4 0 0
3 1 0
3 0 1
""" + b"".join(
    b"3 %d %d %d\n" % (a + k, b + k, c + k) for k in (0, 4) for a, b, c in [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
)
_QUEUED_EDIT = "/v1/jobs/{job_id}/edits/{edit_id}"  # only edits that take long are queued


def test_every_body_has_an_example_of_its_schema() -> None:
    document = contract()
    schemas = document["components"]["schemas"]
    for name in body_schemas(document):
        (example,) = schemas[name]["examples"]
        schema = {"$ref": f"#/components/schemas/{name}", "components": document["components"]}
        jsonschema.Draft202012Validator(schema).validate(example)


def test_the_examples_for_curl_work(client: httpx.Client, finished_job: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "hand.off").write_bytes(TWO_TETRAHEDRA)
    finished = finished_job(TWO_TETRAHEDRA).rpartition("/")[2]
    labelled = finished_job(TWO_TETRAHEDRA).rpartition("/")[2]  # an edit and labels cannot both follow the first parts
    waiting = client.post("/v1/jobs", files={"mesh": ("a.off", TWO_TETRAHEDRA)}, headers=AGAIN).json()["id"]
    batch = client.post("/v1/batches", files={"mesh": ("a.off", TWO_TETRAHEDRA)}).json()["id"]
    document = client.get("/openapi.json").json()
    operations = [(path, method, one) for path, methods in document["paths"].items() for method, one in methods.items()]

    def works(path: str, method: str, operation: dict[str, Any]) -> bool:
        known = waiting if path.endswith("/cancel") else labelled if method == "put" else finished
        known = batch if "batch_id" in path else known
        line = command(method, path, operation, document["components"]["schemas"])
        line = line.replace(SERVER, str(client.base_url)).replace(EXAMPLE_ID, known)
        line = line.replace("curl", "curl --fail --silent", 1)
        return subprocess.run(["bash", "-c", line], cwd=tmp_path, capture_output=True, check=False).returncode == 0

    operations.sort(key=lambda one: _turn(*one[:2]))
    for operation in operations:
        if operation[0] not in (_QUEUED_EDIT, "/readyz"):  # there is no worker
            wait_until(lambda operation=operation: works(*operation))  # the first edit waits for its process
    saved = {path.name for path in tmp_path.iterdir()}
    assert {"model.glb", "model.obj.zip", "parts.zip", "preview.png", "results.zip", "result.cleave"} <= saved


def _turn(path: str, method: str) -> int:
    """The turn of an operation: what needs the automatic parts comes before edits, and all else before deletion."""
    if path.endswith("/preview"):
        return 0
    return 3 if method == "delete" else 1 if path.endswith("/edits") else 2
