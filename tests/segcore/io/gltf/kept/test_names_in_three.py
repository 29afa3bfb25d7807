"""three.js changes the names of nodes; the exact names come back in its ``userData``."""

import io
import json
from pathlib import Path

import numpy as np
import pytest

from helpers.files.kept import kept
from helpers.files.rich_gltf import rich_asset
from helpers.files.written import written
from helpers.hierarchies import hierarchy_of_labels
from helpers.node.programs import install, run
from segcore.io import read_mesh

NAMES = {0: "left arm", 1: "a.b:c/d[2]\\e", 2: "Rad außen", 3: "left arm"}
EXACT = ["left arm", "a.b:c/d[2]\\e", "Rad außen", "left arm 3"]  # the label is added to a name that another part has


@pytest.mark.slow
def test_exact_names_of_parts_come_back_from_three_js(tmp_path: Path) -> None:
    script = install("three", tmp_path) / "read.mjs"
    mesh = read_mesh(io.BytesIO(rich_asset().glb()))
    hierarchy = hierarchy_of_labels(np.arange(len(mesh.faces)) % 4)
    files = {
        "tree": written("glb", mesh, hierarchy, names=NAMES),
        "flat": written("glb", mesh, hierarchy, names=NAMES, layout="flat"),
        "kept": kept(rich_asset().glb(), hierarchy, names=NAMES),
    }
    paths = {name: str(tmp_path / f"{name}.glb") for name in files}
    for name, data in files.items():
        Path(paths[name]).write_bytes(data)
    parts = json.loads(run(script, [], json.dumps(list(paths.values()))))["parts"]
    for name in ("tree", "flat"):
        assert sorted(part["name"] for part in parts[paths[name]]) == sorted(EXACT)
    assert {part["name"] for part in parts[paths["kept"]]} == set(EXACT)
