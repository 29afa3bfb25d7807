"""Corrections of the OpenAPI document, so that types made from it are exact."""

from typing import Any

# Their fields with defaults are read from results of earlier versions, but always sent.
_COMPLETE = ("MeshReport", "Health")


def make_exact(document: dict[str, Any]) -> None:
    """Say which fields are always sent, and remove null from the values of parameters."""
    schemas = document["components"]["schemas"]
    for name in _COMPLETE:
        fields = schemas[name]["properties"]
        schemas[name]["required"] = list(fields)
        for field in fields.values():
            field.pop("default", None)
    for operations in document["paths"].values():
        for operation in operations.values():
            for parameter in operation.get("parameters", ()):
                _remove_null(parameter.get("schema", {}))


def _remove_null(schema: dict[str, Any]) -> None:
    """Replace "something or null" by something: a parameter is sent or not, but no text means null."""
    choices = [choice for choice in schema.get("anyOf", ()) if choice != {"type": "null"}]
    if len(choices) == 1:
        del schema["anyOf"]
        schema.update(choices[0] | schema)
