"""Run by a Python that has Cleave: segments the mesh in a folder, and writes labels and hierarchy into it.

Arguments: the folder, and a folder of packages that this Python shall use, or an empty text.
"""

import json
import sys
from pathlib import Path

MESH, LABELS, HIERARCHY, STATE, ERROR = "mesh.ply", "labels.npy", "hierarchy.json", "state.txt", "error.txt"
MISSING = 3  # exit status: Cleave is not installed
REFUSED = 2  # the last line of the errors says what is wrong with the mesh


def main(folder: Path, packages: str) -> int:
    if packages:
        sys.path.insert(0, packages)
    try:
        import numpy as np

        import segcore
        from segcore.io.labels import hierarchy_document
        from segcore.kernels import FIRST, compile_kernels
    except ModuleNotFoundError as error:
        sys.stderr.write(f"{error}\n")
        return MISSING
    state = folder / STATE
    compile_kernels(FIRST, lambda done: _tell(state, f"compiling, only this once, {done.done / done.count:.0%}"))
    try:
        mesh = segcore.read_mesh(folder / MESH)
        hierarchy = segcore.segment(mesh, on_progress=lambda stage, done: _tell(state, f"{stage} {done:.0%}"))
    except segcore.CleaveError as error:
        sys.stderr.write(f"{error}\n")
        return REFUSED
    np.save(folder / LABELS, hierarchy.labels(hierarchy.max_segments))
    (folder / HIERARCHY).write_text(json.dumps(hierarchy_document(hierarchy)), encoding="ascii")
    return 0


def _tell(state: Path, text: str) -> None:
    state.write_text(text, encoding="ascii")


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2]))
