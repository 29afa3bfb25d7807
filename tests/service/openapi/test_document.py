"""The completed OpenAPI document."""

import httpx

from service.openapi.export import contract
from service.problems import STATUS


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
    # These can occur on every path, or only on undocumented ones.
    assert set(STATUS) - shown == {"not_found", "method_not_allowed", "internal_error"}


def test_without_keys_the_document_requires_none(client: httpx.Client) -> None:
    document = client.get("/openapi.json").json()
    assert "securitySchemes" not in document["components"]
    assert "security" not in document["paths"]["/v1/jobs"]["get"]
    assert contract()["paths"]["/v1/jobs"]["get"]["security"] == [{"ApiKey": []}]
