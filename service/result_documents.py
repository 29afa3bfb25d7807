"""The hierarchy as it is answered."""

from typing import Any

from segcore.io.labels import hierarchy_document
from segcore.io.result import Segmentation


def hierarchy_of(result: Segmentation) -> dict[str, Any]:
    """The tree of cuts, and the curve that helps to choose a number of segments."""
    document = hierarchy_document(result.hierarchy)
    nodes = result.hierarchy.split_node.tolist()
    curve = [
        {"segments": split + 2, "cut_value": value, "node": node}
        for split, (value, node) in enumerate(zip(document["cut_values"], nodes, strict=True))
    ]
    return document | {"curve": curve}
