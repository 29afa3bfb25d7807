"""What the extension remembers of a mesh, in a custom property of it: so it is saved and undone with the file."""

import json
from typing import Any

import bpy

_PROPERTY = "cleave"


def record(mesh: bpy.types.Mesh) -> dict[str, Any]:
    """Return ``job``, ``server`` and ``topology`` of the job on a server, ``groups`` (names of vertex groups)."""
    try:
        found = json.loads(mesh.get(_PROPERTY, "{}"))
    except (ValueError, TypeError):
        return {}  # somebody else's property
    return found if isinstance(found, dict) else {}


def keep(mesh: bpy.types.Mesh, **facts: Any) -> None:
    """Change some facts of the record."""
    mesh[_PROPERTY] = json.dumps(record(mesh) | facts)
