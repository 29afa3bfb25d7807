"""Schemas of the OpenAPI document as Markdown: the type of a value, and tables of the fields of an object."""

import json
from collections.abc import Iterator
from typing import Any, TypeAlias

Schema: TypeAlias = dict[str, Any]
_PLACE = "#/components/schemas/"
_FIELDS = ("field", "type", "description")


def type_of(schema: Schema) -> str:
    """Return the type of a value, with links to the sections of named schemas."""
    choices = schema.get("anyOf", schema.get("oneOf"))
    if "$ref" in schema:
        name = schema["$ref"].removeprefix(_PLACE)
        return f"[{name}](#{name.lower()})"
    if "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema["enum"])
    if choices is not None:
        return " or ".join(map(type_of, choices))
    if "const" in schema:
        return f"`{schema['const']}`"
    if "contentSchema" in schema:
        return f"{type_of(schema['contentSchema'])} as text"
    match schema.get("type"):
        case "array":
            return f"array of {type_of(schema.get('items') or schema['prefixItems'][0])}"
        case "object" if isinstance(schema.get("additionalProperties"), dict):
            return f"object of {type_of(schema['additionalProperties'])}"
        case "string" if "format" in schema:
            return {"binary": "bytes"}.get(schema["format"], str(schema["format"]))
        case "integer" | "number":
            return _number(schema)
    return str(schema.get("type", "any value"))


def _number(schema: Schema) -> str:
    low = _whole(schema.get("minimum", schema.get("exclusiveMinimum")))
    high = _whole(schema.get("maximum", schema.get("exclusiveMaximum")))
    if low is None:
        return str(schema["type"]) if high is None else f"{schema['type']} up to {high}"
    return f"{schema['type']} from {low}" if high is None else f"{schema['type']} {low} to {high}"


def _whole(bound: float | None) -> float | None:
    """Return 1 for 1.0."""
    return int(bound) if isinstance(bound, float) and bound.is_integer() else bound


def description_of(schema: Schema) -> str:
    """Return the description of a value, with its default."""
    default = f" Default: `{_shown(schema['default'])}`." if "default" in schema else ""
    return f"{schema.get('description', '')}{default}".strip()


def _shown(default: object) -> str:
    """Return a default as JSON; of a text that is not empty without quotation marks."""
    return str(default) if isinstance(default, str) and default else json.dumps(default)


def fields_of(schema: Schema) -> Iterator[str]:
    """Yield the table of the fields of an object; nothing if the schema is none."""
    if "properties" in schema:
        yield from table(_FIELDS, [_row(schema, name) for name in schema["properties"]])


def union_fields(schema: Schema, schemas: dict[str, Schema]) -> Iterator[str]:
    """Yield the fields that the objects of a union share, then those in which each of them differs from the first."""
    first, *others = [schemas[one["$ref"].removeprefix(_PLACE)] for one in schema["oneOf"]]
    by = schema["discriminator"]["propertyName"]
    yield from table(_FIELDS, [_row(first, name) for name in first["properties"] if name != by])
    for one in (first, *others):
        value = one["properties"][by]["const"]
        yield from ("", f"With `{by}` `{value}`: {one['description']}")
        own = [name for name in one["properties"] if name != by and _row(one, name) != _row(first, name)]
        if own:
            yield from table(_FIELDS, [_row(one, name) for name in own])


def members_of_unions(schemas: dict[str, Schema]) -> set[str]:
    """Return the names of the schemas that are described with the union that they belong to."""
    return {
        one["$ref"].removeprefix(_PLACE)
        for schema in schemas.values()
        if "discriminator" in schema
        for one in schema["oneOf"]
    }


def _row(schema: Schema, name: str) -> tuple[str, str, str]:
    value = schema["properties"][name]
    optional = "" if name in schema.get("required", []) or "default" in value else " (optional)"
    return f"`{name}`{optional}", type_of(value), description_of(value)


def table(head: tuple[str, ...], rows: list[Any]) -> Iterator[str]:
    """Yield the lines of a table in Markdown."""
    yield ""
    yield f"| {' | '.join(head)} |"
    yield "|---" * len(head) + "|"
    for row in rows:
        yield "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", " ") for cell in row) + " |"
