"""The exceptions of segcore.

CleaveError
 |- InvalidMesh         the file or the arrays cannot be segmented as given: fix the mesh
 |- UnsupportedFormat   the file has a format that is not supported: convert it
 |- InvalidParameters   a value is outside its documented range: fix the call
 |- PartLocked          an edit would change a part that is locked: unlock it
 |- MissingPackage      an optional package is not installed: install it
 `- LimitExceeded       the input is larger than this installation accepts: reduce it or raise the limit

Every class has a stable ``code`` for programs. The message is one sentence for people and names a remedy.
"""


class CleaveError(Exception):
    """Base class of all expected errors."""

    code = "error"


class InvalidMesh(CleaveError):  # noqa: N818
    """The file or the arrays cannot be segmented as given."""

    code = "invalid_mesh"


class UnsupportedFormat(CleaveError):  # noqa: N818
    """The file has a format, or uses a feature of one, that is not supported."""

    code = "unsupported_format"


class InvalidParameters(CleaveError, ValueError):  # noqa: N818
    """A parameter is outside its documented range."""

    code = "invalid_parameters"


class PartLocked(CleaveError):  # noqa: N818
    """An edit would change the faces of a part that is locked."""

    code = "part_locked"


class MissingPackage(CleaveError):  # noqa: N818
    """An optional package that the call needs is not installed."""

    code = "missing_package"


class LimitExceeded(CleaveError):  # noqa: N818
    """The input is larger than this installation accepts."""

    code = "limit_exceeded"
