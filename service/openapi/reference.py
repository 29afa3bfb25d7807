"""The reference of the API, made of its OpenAPI document: as Markdown for docs/api.md, as HTML for /docs."""

from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from typing import Any

from service.problems import MEANING, STATUS

_NO_TAG = "other"


@dataclass(frozen=True, slots=True)
class Operation:
    """One thing that a client can ask for."""

    method: str
    path: str
    group: str
    sentence: str
    parameters: list[tuple[str, str, str]]  # name, where, description
    bodies: list[str]  # media types
    answers: list[tuple[str, str, str]]  # status, media types, description


def operations(document: dict[str, Any]) -> list[Operation]:
    return [
        Operation(
            method=method.upper(),
            path=path,
            group=operation.get("tags", [_NO_TAG])[0],
            sentence=operation.get("description", operation.get("summary", "")),
            parameters=[
                (parameter["name"], parameter["in"], _about_parameter(parameter))
                for parameter in operation.get("parameters", [])
            ],
            bodies=list(operation.get("requestBody", {}).get("content", {})),
            answers=[
                (status, ", ".join(response.get("content", {})), response["description"])
                for status, response in sorted(operation["responses"].items())
            ],
        )
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
    ]


def markdown(document: dict[str, Any]) -> str:
    """The whole reference; the same document gives the same text."""
    return "\n".join(_markdown_lines(document)) + "\n"


def html_body(document: dict[str, Any]) -> str:
    """The same as the inside of a page, without style or script."""
    parts = [f"<h1>{escape(document['info']['title'])} API</h1>"]
    parts += [f"<p>{escape(paragraph)}</p>" for paragraph in document["info"]["description"].strip().split("\n\n")]
    parts.append('<p>For programs: <a href="/openapi.json">openapi.json</a>.</p>')
    for operation in operations(document):
        parts.append(f"<h2><code>{operation.method} {escape(operation.path)}</code></h2>")
        parts.append(f"<p>{escape(operation.sentence)}</p>")
        parts.append(_table(("parameter", "in", "description"), operation.parameters))
        if operation.bodies:
            parts.append(f"<p>Body: {', '.join(f'<code>{escape(body)}</code>' for body in operation.bodies)}</p>")
        parts.append(_table(("answer", "type", "description"), operation.answers))
    parts.append("<h2>Parameters of the segmentation</h2>")
    parts.append(_table(("name", "values", "default", "description"), _method_rows(document)))
    parts.append("<h2>Errors</h2>")
    parts.append(_table(("code", "status", "meaning"), [(code, str(STATUS[code]), MEANING[code]) for code in STATUS]))
    return "\n".join(parts)


def _markdown_lines(document: dict[str, Any]) -> Iterator[str]:
    yield "# The HTTP API"
    yield ""
    yield "Made by `python -m service.openapi.export` of the same source as `/openapi.json` and `/docs`."
    yield ""
    yield document["info"]["description"].strip()
    for operation in operations(document):
        yield from ("", f"## `{operation.method} {operation.path}`", "", operation.sentence)
        if operation.parameters:
            yield from _markdown_table(("parameter", "in", "description"), operation.parameters)
        if operation.bodies:
            yield from ("", "Body: " + ", ".join(f"`{body}`" for body in operation.bodies))
        yield from _markdown_table(("answer", "type", "description"), operation.answers)
    yield from ("", "## Parameters of the segmentation")
    yield from _markdown_table(("name", "values", "default", "description"), _method_rows(document))
    yield from ("", "## Errors")
    rows = [(f"`{code}`", str(status), MEANING[code]) for code, status in STATUS.items()]
    yield from _markdown_table(("code", "status", "meaning"), rows)


def _method_rows(document: dict[str, Any]) -> list[tuple[str, ...]]:
    properties = document["components"]["schemas"]["Parameters"]["properties"]
    return [
        (name, _values(schema), "" if "default" not in schema else str(schema["default"]), schema["description"])
        for name, schema in properties.items()
    ]


def _values(schema: dict[str, Any]) -> str:
    if "enum" in schema:
        return ", ".join(map(str, schema["enum"]))
    if "anyOf" in schema:
        return " or ".join(_values(part) for part in schema["anyOf"])
    if "const" in schema:
        return str(schema["const"])
    low = schema.get("minimum", schema.get("exclusiveMinimum"))
    high = schema.get("maximum", schema.get("exclusiveMaximum"))
    return str(schema["type"]) if low is None else f"{schema['type']} {low} to {high}"


def _about_parameter(parameter: dict[str, Any]) -> str:
    schema = parameter.get("schema", {})
    default = f" Default: {schema['default']}." if schema.get("default") is not None else ""
    return str(parameter.get("description", "")) + default


def _markdown_table(head: tuple[str, ...], rows: list[Any]) -> Iterator[str]:
    yield ""
    yield f"| {' | '.join(head)} |"
    yield "|---" * len(head) + "|"
    for row in rows:
        yield "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", " ") for cell in row) + " |"


def _table(head: tuple[str, ...], rows: list[Any]) -> str:
    if not rows:
        return ""
    lines = ["<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows]
    return f"<table><tr>{''.join(f'<th>{escape(name)}</th>' for name in head)}</tr>{''.join(lines)}</table>"
