"""CoACD in a process of its own: ``python decomposition.py FOLDER K ...``.

It reads the arrays ``vertices`` and ``faces`` of part K from ``K.npz`` in the folder, and its options from ``K.json``.
It writes the vertices of the convex pieces to ``K.pieces.npz``, for one part after the other.

References
----------
X. Wei, M. Liu, Z. Ling, H. Su, Approximate convex decomposition for 3D meshes with collision-aware concavity and tree
search, ACM Transactions on Graphics 41(4), 2022.
"""

import json
import os
import signal
import sys
from pathlib import Path

import numpy as np

PART, OPTIONS, PIECES = "{}.npz", "{}.json", "{}.pieces.npz"
_NICENESS = 10  # a service that waits for it answers other requests meanwhile
_CPU_S = 30  # of a part, set by hand: several times what parts of the measured models take


def main(folder: Path, parts: list[str]) -> None:
    """Decompose parts; a part that takes too long ends the process, as does one at which the library fails."""
    import coacd

    os.nice(_NICENESS)
    coacd.set_log_level("off")
    for part in parts:
        signal.setitimer(signal.ITIMER_VIRTUAL, _CPU_S)  # its signal ends a process, whatever it computes
        with np.load(folder / PART.format(part)) as arrays:
            mesh = coacd.Mesh(arrays["vertices"], arrays["faces"])
        found = coacd.run_coacd(mesh, **json.loads((folder / OPTIONS.format(part)).read_text()))
        written = folder / "written.npz"
        np.savez(written, *[np.asarray(vertices) for vertices, _ in found])
        os.replace(written, folder / PIECES.format(part))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
