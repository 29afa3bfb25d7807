"""The errors that segcore raises on purpose.

CleaveError
 |- InvalidMesh         the file or the arrays cannot be segmented as given: fix the mesh
 |- UnsupportedFormat   the file is of a kind that is not read here: convert it
 |- InvalidParameters   a value is outside its documented range: fix the call
 `- LimitExceeded       the input is larger than this installation accepts: reduce it or raise the limit

Every class has a stable ``code`` for programs; the message is one sentence for people that says what to do.
"""


class CleaveError(Exception):
    """Base of every expected failure."""

    code = "error"


class InvalidMesh(CleaveError):  # noqa: N818
    """The file or the arrays cannot be segmented as given."""

    code = "invalid_mesh"


class UnsupportedFormat(CleaveError):  # noqa: N818
    """The bytes are of a file format, or use a feature of one, that is not read here."""

    code = "unsupported_format"


class InvalidParameters(CleaveError, ValueError):  # noqa: N818
    """A parameter is outside its documented range."""

    code = "invalid_parameters"


class LimitExceeded(CleaveError):  # noqa: N818
    """The input is larger than this installation accepts."""

    code = "limit_exceeded"
