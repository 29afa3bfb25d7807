"""The file name in a Content-Disposition header (RFC 6266), of a field of a form or of a whole request."""

import re
from urllib.parse import unquote_to_bytes

from python_multipart.multipart import parse_options_header

# filename*=UTF-8''na%C3%AFve.obj, as in RFC 8187; forms should not use it, and some clients do.
_EXTENDED = re.compile(rb"""filename\*\s*=\s*"?([\w-]+)'[\w-]*'([^;"\s]+)""", re.IGNORECASE)


def file_name_in(disposition: bytes) -> str | None:
    """Return the file name, None if there is none; ``filename*`` counts more than ``filename``.

    Bytes that are not of the encoding are replaced.
    """
    extended = _EXTENDED.search(disposition)
    if extended is not None:
        try:
            return unquote_to_bytes(extended[2]).decode(extended[1].decode("ascii"), "replace")
        except LookupError:  # an encoding that does not exist
            pass
    plain = parse_options_header(disposition)[1].get(b"filename")
    return None if plain is None else plain.decode("utf-8", "replace")
