"""Examples of JSON bodies: responses of a service to a mesh of two tetrahedra, and requests that it accepts.

The reports of a print and a robot are those of a bar of two halves.
"""

import json
from importlib.resources import files
from typing import Any

from service.job_documents import job_links
from service.openapi.schema_tables import Schema

_PLACE = "#/components/schemas/"
_JOBS = ("SubmittedJobDocument", "UnfinishedJobDocument")  # examples.json has where they differ from JobDocument


def add_examples(document: dict[str, Any]) -> None:
    """Add the examples of examples.json, which are by names of schemas, to the schemas of a document."""
    examples = json.loads(files("service.openapi").joinpath("examples.json").read_text(encoding="utf-8"))
    job = examples["JobDocument"]
    job["links"] = job_links(f"/v1/jobs/{job['id']}").model_dump()
    examples["JobPageDocument"]["jobs"] = [job]
    for name, example in examples.items():
        whole = job | example if name in _JOBS else example
        document["components"]["schemas"][name]["examples"] = [whole]


def example_of(schema: Schema, schemas: dict[str, Schema]) -> Any:
    """Return the first example of the schema of a body, one of a document or a reference to one."""
    if "$ref" in schema:
        schema = schemas[schema["$ref"].removeprefix(_PLACE)]
    if "anyOf" in schema and "examples" not in schema:
        return example_of(schema["anyOf"][0], schemas)
    return schema["examples"][0]


def example_text(example: dict[str, Any]) -> str:
    """Return an example as JSON, with a line for each field."""
    lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(value)}" for name, value in example.items())
    return f"{{\n{lines}\n}}"


def body_schemas(document: dict[str, Any]) -> set[str]:
    """Return the names of the schemas of whole JSON bodies, of requests and responses."""
    operations = [operation for methods in document["paths"].values() for operation in methods.values()]
    contents = [
        message.get("content", {})
        for operation in operations
        for message in (operation.get("requestBody", {}), *operation["responses"].values())
    ]
    bodies = [body.get("schema", {}) for content in contents for name, body in content.items() if name.endswith("json")]
    references = [one["$ref"] for body in bodies for one in (body, *body.get("anyOf", ())) if "$ref" in one]
    return {reference.removeprefix(_PLACE) for reference in references}
