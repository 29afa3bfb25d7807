"""The contract and its reference: what is committed is what is served, and nothing that clients rely on goes away."""

import json
import re
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from service.openapi.export import DOCS, contract, contract_text
from service.openapi.reference import markdown
from service.problems import STATUS

RENEW = "run python -m service.openapi.export, look at what changed, and commit it"


def losses(old: Any, new: Any, place: str = "") -> Iterator[str]:
    """What a client of the old document would miss in the new one."""
    if isinstance(old, dict) and isinstance(new, dict):
        yield from (
            f"{place}/{name} is gone" for name in old if name not in new and name not in ("required", "default")
        )
        for name in old.keys() & new.keys():
            if name not in ("description", "summary", "example", "examples", "title"):
                yield from losses(old[name], new[name], f"{place}/{name}")
        if place.rpartition("/")[2] not in ("properties", "schemas"):
            yield from (f"{place} newly requires {name}" for name in set(needs(new)) - set(needs(old)))
    elif isinstance(old, list) and isinstance(new, list):
        yield from _losses_of_list(old, new, place)
    elif old != new and place.rpartition("/")[2] not in ("default", "operationId"):
        yield f"{place} was {old!r} and is {new!r}"


def _losses_of_list(old: list[Any], new: list[Any], place: str) -> Iterator[str]:
    if place.endswith("/parameters") and all(isinstance(entry, dict) for entry in old):
        found = {entry["name"]: entry for entry in new}
        yield from (f"{place}/{entry['name']} is gone" for entry in old if entry["name"] not in found)
        for entry in old:
            yield from losses(entry, found.get(entry["name"], entry), f"{place}/{entry['name']}")
    elif not place.endswith("/required"):
        yield from (f"{place} no longer has {entry!r}" for entry in old if entry not in new)


def needs(schema: dict[str, Any]) -> list[str]:
    """What a client must send."""
    required = schema.get("required", [])
    return [str(name) for name in required] if isinstance(required, list) and "properties" in schema else []


def test_nothing_that_clients_rely_on_goes_away() -> None:
    committed = json.loads((DOCS / "openapi.json").read_text())
    assert list(losses(committed, contract())) == []


def test_the_committed_documents_are_those_that_are_served() -> None:
    document = contract()
    assert (DOCS / "openapi.json").read_text() == contract_text(document), RENEW
    assert (DOCS / "api.md").read_text() == markdown(document), RENEW


@pytest.mark.parametrize(
    ("change", "loss"),
    [
        (lambda d: d["paths"].pop("/v1/formats"), "/paths//v1/formats is gone"),
        (lambda d: d["paths"]["/v1/jobs"]["get"]["responses"].pop("200"), "responses/200 is gone"),
        (lambda d: d["components"]["schemas"]["JobDocument"]["properties"].pop("stage"), "properties/stage is gone"),
        (lambda d: d["paths"]["/v1/jobs"]["get"]["parameters"].pop(), "parameters/"),
        (lambda d: d["components"]["schemas"]["BatchJobs"]["required"].append("name"), "newly requires name"),
        (lambda d: d["components"]["schemas"]["Parameters"]["properties"]["solver"]["enum"].remove("flow"), "'flow'"),
        (lambda d: d["components"]["schemas"]["LabelsDocument"]["properties"]["segments"].update(type="string"), "was"),
    ],
)
def test_what_breaks_clients_is_seen(change: Any, loss: str) -> None:
    old, new = contract(), contract()
    change(new)
    assert any(loss in found for found in losses(old, new))


def test_every_error_has_an_example_and_every_code_is_documented() -> None:
    document = contract()
    shown: set[str] = set()
    for path in document["paths"].values():
        for operation in path.values():
            for status, response in operation["responses"].items():
                content = response.get("content", {}).get("application/problem+json")
                for code, example in content["examples"].items() if content else ():
                    assert example["value"]["status"] == int(status) == STATUS[code]
                    assert example["value"]["detail"].endswith(".") or code == "job_failed"
                    shown.add(code)
    # These can be met on every path, or on none that is documented.
    assert set(STATUS) - shown == {"not_found", "method_not_allowed", "internal_error"}


def test_the_reference_page_loads_nothing_from_elsewhere(client: httpx.Client) -> None:
    page = client.get("/docs")
    assert page.headers["Content-Type"].startswith("text/html")
    assert "default-src 'self'" in page.headers["Content-Security-Policy"]
    assert "<script" not in page.text
    for address in re.findall(r'(?:src|href)="([^"]*)"', page.text):
        assert client.get(address).status_code == 200
    assert "/v1/jobs/{job_id}/labels" in page.text
    assert "idempotency_key_reused" in page.text


def test_without_keys_the_document_asks_for_none(client: httpx.Client) -> None:
    document = client.get("/openapi.json").json()
    assert "securitySchemes" not in document["components"]
    assert "security" not in document["paths"]["/v1/jobs"]["get"]
    assert contract()["paths"]["/v1/jobs"]["get"]["security"] == [{"ApiKey": []}]
