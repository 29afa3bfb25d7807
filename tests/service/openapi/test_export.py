"""The committed documents are current and compatible with their earlier versions."""

import json
from collections.abc import Iterator
from typing import Any

import pytest

from service.openapi.export import DOCS, PAGE_LISTS, contract, contract_text, page_lists_text, reference_text

RENEW = "run python -m service.openapi.export, review the changes and commit them"


def losses(old: Any, new: Any, place: str = "") -> Iterator[str]:
    """Yield the changes that break clients of the old document."""
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
    """Return the properties that a client must send."""
    required = schema.get("required", [])
    return [str(name) for name in required] if isinstance(required, list) and "properties" in schema else []


def test_the_document_is_compatible_with_the_committed_one() -> None:
    committed = json.loads((DOCS / "openapi.json").read_text())
    assert list(losses(committed, contract())) == []


def test_the_committed_documents_are_current() -> None:
    document = contract()
    assert (DOCS / "openapi.json").read_text() == contract_text(document), RENEW
    assert (DOCS / "reference" / "api.md").read_text() == reference_text(document), RENEW
    assert PAGE_LISTS.read_text() == page_lists_text(), RENEW


@pytest.mark.parametrize(
    ("change", "loss"),
    [
        (lambda d: d["paths"].pop("/v1/formats"), "/paths//v1/formats is gone"),
        (lambda d: d["paths"]["/v1/jobs"]["get"]["responses"].pop("200"), "responses/200 is gone"),
        (lambda d: d["components"]["schemas"]["QueuedJob"]["properties"].pop("stage"), "properties/stage is gone"),
        (lambda d: d["paths"]["/v1/jobs"]["get"]["parameters"].pop(), "parameters/"),
        (lambda d: d["components"]["schemas"]["BatchJobs"]["required"].append("name"), "newly requires name"),
        (lambda d: d["components"]["schemas"]["Parameters"]["properties"]["solver"]["enum"].remove("flow"), "'flow'"),
        (lambda d: d["components"]["schemas"]["LabelsDocument"]["properties"]["segments"].update(type="string"), "was"),
    ],
)
def test_incompatible_changes_are_detected(change: Any, loss: str) -> None:
    old, new = contract(), contract()
    change(new)
    assert any(loss in found for found in losses(old, new))
