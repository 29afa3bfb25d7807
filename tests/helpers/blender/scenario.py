"""The extension in Blender, from its installation to its removal; prints nothing, writes what was seen as JSON.

Arguments: the zip of the extension, the URL of a server and the key for it, a script of the documentation, and the file
that is written.
"""

import json
import sys
import time
import urllib.request
from pathlib import Path
from typing import Any

import bpy
from facts import ADDON, attribute, contents, geometry, refusal, registered, select
from interface import beside_the_interface
from models import five_models

ZIP, URL, KEY, SCRIPT, TARGET = sys.argv[1:]


def api(path: str, body: Any = None) -> Any:
    data = None if body is None else json.dumps(body).encode()
    headers = {"Authorization": f"Bearer {KEY}", "Content-Type": "application/json"}
    with urllib.request.urlopen(urllib.request.Request(URL + path, data, headers)) as response:
        return json.load(response)


def job_count() -> int:
    return len(api("/v1/jobs?limit=200")["jobs"])


def several_objects() -> dict[str, Any]:
    """Five models in one call, then other levels of one of them."""
    models = five_models()
    select(*models)
    before = job_count()
    bpy.ops.object.cleave_segment(groups=True)
    seen = {
        entry.name: {
            "geometry": geometry(entry, evaluated=entry.name != "head"),
            "labels": attribute(entry.data),
            "face_sets": attribute(entry.data, ".sculpt_face_set"),
            **contents(entry),
        }
        for entry in models
    }
    after = job_count()
    levels = {}
    for segments in (1, 2, 3, 5, 1000):
        bpy.ops.object.cleave_segment(level="NUMBER", segments=segments)
        levels[segments] = {entry.name: attribute(entry.data) for entry in models}
    bpy.ops.object.cleave_segment(level="GRANULARITY", granularity=1.0)
    levels["finest"] = {entry.name: attribute(entry.data) for entry in models}
    models[0].location = (9, 9, 9)
    models[0].rotation_euler = (1, 2, 3)
    bpy.context.view_layer.update()
    bpy.ops.object.cleave_segment()
    moved = job_count()
    models[0].scale = (1, 1, 3)
    bpy.context.view_layer.update()
    bpy.ops.object.cleave_segment()
    return {"models": seen, "jobs": [before, after, moved, job_count()], "levels": levels}


def undone() -> dict[str, Any]:
    five_models()
    select(bpy.data.objects["table"])
    own = bpy.data.materials.new("own")
    bpy.data.objects["table"].data.materials.append(own)
    bpy.ops.ed.undo_push(message="before")
    first = contents(bpy.data.objects["table"])
    bpy.ops.object.cleave_segment("EXEC_DEFAULT", True, groups=True, separate=True)
    names = sorted(entry.name for entry in bpy.data.objects)
    bpy.ops.ed.undo()
    table = bpy.data.objects["table"]
    second, jobs = contents(table), job_count()
    select(table)
    bpy.ops.object.cleave_segment(level="NUMBER", segments=3)
    return {
        "redone": [len(set(attribute(table.data))), job_count() - jobs],
        "before": first,
        "separated": names,
        "after": second,
        "objects": sorted(entry.name for entry in bpy.data.objects),
        "materials": sorted(material.name for material in bpy.data.materials),
    }


def repeated() -> dict[str, Any]:
    """A second division replaces the first one, and keeps what is not its own."""
    table = five_models()[0]
    table.data.materials.append(bpy.data.materials.new("own"))
    table.vertex_groups.new(name="segment 0")
    select(table)
    bpy.ops.object.cleave_segment(level="NUMBER", segments=5, groups=True)
    first = contents(table)
    bpy.ops.object.cleave_segment(level="NUMBER", segments=2, groups=True)
    return {"first": first, "second": contents(table), "labels": attribute(table.data)}


def separated() -> dict[str, Any]:
    """Two objects with one mesh and the stool, whose shape key and loose edge are kept."""
    models = five_models()
    table, stool = models[0], models[4]
    twin = table.copy()
    twin.name = "twin"
    bpy.context.collection.objects.link(twin)
    other = table.copy()
    other.name = "other"
    bpy.context.collection.objects.link(other)
    select(table, twin, stool)
    bpy.ops.object.cleave_segment(attribute=True, materials=False)
    labels = {entry.name: attribute(entry.data) for entry in (table, stool)}
    before = len(bpy.data.meshes), len(bpy.data.shape_keys)
    centres = {entry.name: [list(polygon.center) for polygon in entry.data.polygons] for entry in (table, stool)}
    bpy.ops.object.cleave_segment(separate=True)
    bpy.context.view_layer.update()
    return {
        "labels": labels,
        "centres": centres,
        "meshes and keys": [before, (len(bpy.data.meshes), len(bpy.data.shape_keys))],
        "objects": {
            entry.name: {
                "labels": attribute(entry.data),
                "centres": [list(polygon.center) for polygon in entry.data.polygons],
                "matrix": [list(row) for row in entry.matrix_world],
                "loose": sum(edge.is_loose for edge in entry.data.edges),
                "keys": [key.name for key in entry.data.shape_keys.key_blocks] if entry.data.shape_keys else [],
                "selected": entry.select_get(),
            }
            for entry in bpy.data.objects
            if entry.type == "MESH" and entry.name.partition(" ")[0] in ("table", "twin", "stool", "other")
        },
    }


def corrected() -> dict[str, Any]:
    table = five_models()[0]
    select(table)
    bpy.ops.object.cleave_segment()
    job = json.loads(table.data["cleave"])["job"]
    early = refusal(bpy.ops.object.cleave_fetch)
    operations = [{"op": "name", "part": 0, "name": "board"}, {"op": "merge", "parts": [1, 2]}]
    api(f"/v1/jobs/{job}/edits", {"base": 0, "operations": operations})
    bpy.ops.object.cleave_fetch(groups=True)
    seen = {"early": early, "labels": attribute(table.data), "geometry": geometry(table, False), **contents(table)}
    seen["api"] = api(f"/v1/jobs/{job}/labels?revision=latest")
    api(f"/v1/jobs/{job}/edits", {"base": 1, "operations": [{"op": "name", "part": 1, "name": "leg"}]})
    bpy.ops.object.cleave_fetch(separate=True)
    seen["objects"] = sorted(entry.name for entry in bpy.context.selected_objects)
    changed = bpy.data.objects["dumbbell"]
    select(changed)
    seen["never sent"] = refusal(bpy.ops.object.cleave_fetch)
    bpy.ops.object.cleave_segment()
    bpy.ops.object.mode_set(mode="EDIT")
    seen["edit mode"] = refusal(bpy.ops.object.cleave_segment)
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    seen["changed"] = refusal(bpy.ops.object.cleave_fetch)
    return seen


def refused() -> dict[str, Any]:
    """What people are told if something is missing."""
    chosen = bpy.context.preferences.addons[ADDON].preferences
    head = five_models()[2]
    seen = {}
    select()
    seen["nothing"] = refusal(bpy.ops.object.cleave_segment)
    empty = bpy.data.objects.new("empty", bpy.data.meshes.new("empty"))
    bpy.context.collection.objects.link(empty)
    select(head, empty)
    seen["no faces"] = refusal(bpy.ops.object.cleave_segment)
    select(head)
    head.data.attributes.new("cleave_part", "FLOAT", "POINT")
    seen["name taken"] = refusal(bpy.ops.object.cleave_segment)
    chosen.server = "https://cleave.example.org"
    seen["offline"] = refusal(bpy.ops.object.cleave_segment)
    chosen.server = URL.rpartition(":")[0] + ":1"
    seen["no server"] = refusal(bpy.ops.object.cleave_segment)
    chosen.place, chosen.python = "LOCAL", "/nowhere/python"
    seen["no python"] = refusal(bpy.ops.object.cleave_segment)
    chosen.place, chosen.python, chosen.server = "SERVER", "", URL
    return seen


def here() -> dict[str, Any]:
    """On this machine, with the Python that runs this."""
    chosen = bpy.context.preferences.addons[ADDON].preferences
    chosen.place, chosen.python = "LOCAL", sys.executable
    table = five_models()[0]
    select(table)
    bpy.ops.object.cleave_segment(materials=False, face_sets=False)
    seen = {"labels": attribute(table.data), **contents(table)}
    chosen.place, chosen.python = "SERVER", ""
    return seen


def documented() -> dict[str, Any]:
    """The script of the documentation."""
    table = five_models()[0]
    select(table)
    said: list[Any] = []
    exec(Path(SCRIPT).read_text(), {"print": said.append})
    return {"said": [{str(label): count for label, count in said[0].items()}], **contents(table)}


def main() -> None:
    seen: dict[str, Any] = {"version": bpy.app.version_string, "before": registered()}
    bpy.ops.extensions.package_install_files(filepath=ZIP, repo="user_default", enable_on_install=True)
    seen["installed"] = registered()
    chosen = bpy.context.preferences.addons[ADDON].preferences
    seen["first place"] = chosen.place
    chosen.place, chosen.server, chosen.api_key = "SERVER", URL, KEY
    steps = (several_objects, undone, repeated, separated, corrected, documented, refused, here, beside_the_interface)
    for step in steps:
        begin = time.monotonic()
        seen[step.__name__] = step()
        sys.stderr.write(f"{step.__name__} {time.monotonic() - begin:.1f} s\n")
    bpy.ops.extensions.package_uninstall(repo_index=1, pkg_id="cleave_parts")
    seen["removed"] = registered()
    Path(TARGET).write_text(json.dumps(seen))


main()
