"""The API reference in Markdown, made from the OpenAPI document: docs/reference/api.md, and the source of /docs."""

from collections.abc import Iterator
from itertools import groupby
from operator import itemgetter
from typing import Any, TypeAlias

from service.openapi.curl import command
from service.openapi.examples import example_text
from service.openapi.schema_tables import (
    Schema,
    description_of,
    fields_of,
    members_of_unions,
    table,
    type_of,
    union_fields,
)
from service.problems import MEANING, MEDIA_TYPE, STATUS

Operation: TypeAlias = dict[str, Any]
_NO_TAG = "other"
_TITLES = {"health": "Health and metrics"}  # of groups; the others are called as their tag


def markdown(document: dict[str, Any]) -> str:
    """Return the reference; it depends on the document alone."""
    return "\n".join(_lines(document)) + "\n"


def _lines(document: dict[str, Any]) -> Iterator[str]:
    yield "# The HTTP API"
    yield ""
    yield document["info"]["description"].strip()
    for group, operations in groupby(_operations(document), key=itemgetter(0)):
        yield from ("", f"## {_TITLES.get(group, group.capitalize())}")
        for _, method, path, operation in operations:
            yield from ("", f"### `{method.upper()} {path}`", "")
            yield from _operation(operation)
            yield from _block("sh", command(method, path, operation, document["components"]["schemas"]))
    yield from ("", "## Documents", "", "The JSON bodies of requests and responses.")
    yield from _documents(document["components"]["schemas"])
    yield from (
        "",
        "## Errors",
        "",
        f"Their media type is `{MEDIA_TYPE}`, their type [ProblemDocument](#problemdocument).",
    )
    rows = [(f"`{code}`", str(status), MEANING[code]) for code, status in STATUS.items()]
    yield from table(("code", "status", "meaning"), rows)


def _operations(document: dict[str, Any]) -> list[tuple[str, str, str, Operation]]:
    """Return groups, methods, paths and operations, by group; those outside of /v1 are the last."""
    every = [
        (operation.get("tags", [_NO_TAG])[0], method, path, operation)
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
    ]
    groups = dict.fromkeys(group for group, *_ in sorted(every, key=lambda one: not one[2].startswith("/v1/")))
    return sorted(every, key=lambda one: list(groups).index(one[0]))


def _operation(operation: Operation) -> Iterator[str]:
    yield str(operation.get("description", operation.get("summary", "")))
    if "parameters" in operation:
        rows = [(f"`{one['name']}`", one["in"], *_about_parameter(one)) for one in operation["parameters"]]
        yield from table(("parameter", "in", "type", "description"), rows)
    if "requestBody" in operation:
        body = operation["requestBody"]
        yield from ("", f"Body: {body.get('description', '')}")
        yield from table(("body", "type"), _content_rows(body["content"]))
        yield from _fields(body["content"])
    yield from _responses(sorted(operation["responses"].items()))


def _responses(responses: list[tuple[str, dict[str, Any]]]) -> Iterator[str]:
    problems = [
        (status, one["content"][MEDIA_TYPE]) for status, one in responses if MEDIA_TYPE in one.get("content", ())
    ]
    rows = [
        (status, media_type, body, one["description"] if i == 0 else "")
        for status, one in responses
        if MEDIA_TYPE not in one.get("content", ())
        for i, (media_type, body) in enumerate(_content_rows(one.get("content", {})) or [("", "")])
    ]
    yield from table(("response", "media type", "type", "description"), rows)
    for _, one in responses:
        yield from _fields(one.get("content", {}))
    codes = [f"{status} {', '.join(f'`{code}`' for code in problem['examples'])}" for status, problem in problems]
    yield from ("", f"[Errors](#errors): {'; '.join(codes)}.")


def _about_parameter(parameter: dict[str, Any]) -> tuple[str, str]:
    content = parameter.get("content", {}).values()
    schema = next((one["schema"] for one in content), parameter.get("schema", {}))
    described = {"description": parameter.get("description", "")}
    if schema.get("default") is not None:
        described["default"] = schema["default"]
    return type_of(schema), description_of(described)


def _content_rows(content: dict[str, Any]) -> list[tuple[str, str]]:
    """Return media types and what they contain."""
    return [(f"`{media_type}`", type_of(one.get("schema", {}))) for media_type, one in content.items()]


def _fields(content: dict[str, Any]) -> Iterator[str]:
    """Yield the tables of the fields of objects that have no section of their own."""
    for media_type, one in content.items():
        if "properties" in one.get("schema", {}):
            yield from ("", f"Fields of `{media_type}`:")
            yield from fields_of(one["schema"])


def _documents(schemas: dict[str, Schema]) -> Iterator[str]:
    described_elsewhere = members_of_unions(schemas)
    for name, schema in sorted(schemas.items()):
        if name in described_elsewhere:
            continue
        yield from ("", f"### {name}")
        if "description" in schema:
            yield from ("", schema["description"])
        if "discriminator" in schema:
            yield from union_fields(schema, schemas)
        else:
            yield from fields_of(schema)
        if "examples" in schema:
            yield from _block("json", example_text(schema["examples"][0]))


def _block(language: str, text: str) -> Iterator[str]:
    yield from ("", f"```{language}", text, "```")
