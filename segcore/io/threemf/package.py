"""Package: the parts of a 3MF file, which is a ZIP archive."""

import re

from segcore.errors import UnsupportedFormat
from segcore.io.limits import ReadLimits
from segcore.io.zip_members import ZipMembers

_ROOT_RELATIONSHIPS = "_rels/.rels"
_LARGEST_RELATIONSHIPS = 2**20  # bytes, set by hand; the usual file has less than 1 kB
_MODEL_TYPE = b"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_RELATIONSHIP = re.compile(rb"<(?:\w+:)?Relationship\b[^>]*>")
_TARGET = re.compile(rb"""\bTarget\s*=\s*(?:"([^"]*)"|'([^']*)')""")
_USUAL_MODEL = "3D/3dmodel.model"


class Package(ZipMembers):
    """A package in memory; the unpacked parts together have at most ``limits.max_uncompressed_bytes``."""

    def __init__(self, data: bytes, limits: ReadLimits) -> None:
        super().__init__(data, limits, "3MF file")

    def root_model(self) -> str:
        """Return the name of the model part according to the relationships of the package, else the usual one."""
        if _ROOT_RELATIONSHIPS in self:
            with self.open(_ROOT_RELATIONSHIPS) as part:
                text = part.read(_LARGEST_RELATIONSHIPS)
            for relationship in _RELATIONSHIP.findall(text):
                target = _TARGET.search(relationship)
                if _MODEL_TYPE in relationship and target:
                    return (target[1] or target[2]).decode("utf-8", "replace")
        if _USUAL_MODEL not in self:
            raise UnsupportedFormat(
                "The ZIP archive contains no 3D model, so it is not a 3MF file: send the mesh itself."
            )
        return _USUAL_MODEL
