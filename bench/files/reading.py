"""Reads files in a process of its own: ``python -m bench.files.reading READER``, a path on each line of the input.

Prints a line of JSON for each: what the reader found in the file, or its refusal.
"""

from __future__ import annotations

import gzip
import json
import resource
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

MOST_MEMORY = 8 * 2**30  # bytes of the address space of the process, set by hand


def cleave(path: Path) -> dict[str, Any]:
    """Return the number of faces and the area, as ``cleave segment`` reads the file.

    If it has polygons, also the area if all of them are triangulated as fans.
    """
    from segcore.io import polygons, read_mesh

    mesh = read_mesh(path, neighbours=True)
    found = measured(mesh.corners) | {"notes": mesh.notes}
    if mesh.source_polygon is not None:
        with patch.object(polygons, "clip_concave_polygons", lambda *_: 0):
            found["area of fans"] = measured(read_mesh(path, neighbours=True).corners)["area"]
    return found


def trimesh(path: Path) -> dict[str, Any]:
    """Return the number of faces and the area of all meshes of the scene, in its coordinates."""
    import trimesh

    packed = path.suffix == ".gz"  # trimesh unpacks none
    with gzip.open(path) if packed else path.open("rb") as file:
        kind = Path(path.stem).suffix if packed else path.suffix
        resolver = trimesh.resolvers.FilePathResolver(str(path))
        scene = trimesh.load_scene(file, file_type=kind[1:].lower(), resolver=resolver, process=False)
    return measured(np.asarray(scene.to_mesh().triangles))


READERS: dict[str, Callable[[Path], dict[str, Any]]] = {"cleave": cleave, "trimesh": trimesh}


def measured(corners: np.ndarray) -> dict[str, Any]:
    """Return the number of triangles (F, 3, 3) and their area."""
    a, b, c = (corners[:, k].astype(np.float64) for k in range(3))
    area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
    return {"faces": len(corners), "area": area}


def answer(reader: Callable[[Path], dict[str, Any]], path: Path) -> dict[str, Any]:
    try:
        return reader(path)
    except Exception as error:  # whatever a reader raises is its answer
        return {"error": type(error).__name__, "message": str(error)[:300]}


def main(name: str) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    out, sys.stdout = sys.stdout, sys.stderr  # readers may print
    for line in sys.stdin:
        print(json.dumps(answer(READERS[name], Path(line.rstrip("\n")))), file=out, flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
