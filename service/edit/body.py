"""The body of an edit, in memory."""

from fastapi import Request

from cleave.settings import Settings
from service.problems import Problem
from service.submit.body import body_chunks, declared_length

# A face takes at most 8 digits and a comma in a list, and may be in several lists.
_BYTES_PER_FACE = 24
_ENVELOPE_BYTES = 4 * 2**20  # for names and everything else; set by hand


async def read_body(request: Request, settings: Settings, faces: int) -> bytes:
    """Return the body of a request about a mesh of so many faces.

    Raises
    ------
    Problem
        If there is no body, it is larger than any edit of the mesh can be, or it arrives too slowly.
    """
    limit = _BYTES_PER_FACE * faces + _ENVELOPE_BYTES
    if request.headers.get("content-encoding", "identity") != "identity":
        raise Problem("unsupported_media_type", "The body is compressed: send it uncompressed.")
    body = bytearray()
    if declared_length(request) <= limit:
        async for chunk in body_chunks(request, settings):
            body += chunk
            if len(body) > limit:
                break
        else:
            return bytes(body)
    raise Problem("too_large", f"An edit of this mesh has at most {limit} bytes: send faces as runs.")
