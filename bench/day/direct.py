"""The labels that segcore gives directly: each line of the input names a mesh file and its parameters in JSON.

The file is run by another version of Cleave as well, and imports segcore alone.
"""

import hashlib
import json
import sys

import numpy as np

import segcore


def main() -> None:
    """Answer each line with the SHA-256 of the labels, as the API gives them with format=raw."""
    for line in sys.stdin:
        order = json.loads(line)
        parameters = segcore.SegmentationParameters(**order["parameters"])
        labels = segcore.segment(segcore.read_mesh(order["mesh"]), parameters).labels()
        digest = hashlib.sha256(labels.astype(np.dtype("<i4")).tobytes()).hexdigest()
        print(json.dumps({"sha256": digest}), flush=True)


if __name__ == "__main__":
    main()
