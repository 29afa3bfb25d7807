"""Pictures of a glTF document that are other files or data URIs: their bytes, unchanged."""

import base64
import binascii
import posixpath
from dataclasses import dataclass
from urllib.parse import unquote, unquote_to_bytes

from segcore.io.file_sets import Companions
from segcore.io.gltf.document import Item

_SHOWN = 80  # characters of an address in a note
_SIGNATURES = (
    (b"\x89PNG\r\n\x1a\n", "image/png"),
    (b"\xff\xd8\xff", "image/jpeg"),
    (b"\xabKTX 20\xbb\r\n\x1a\n", "image/ktx2"),
    (b"DDS ", "image/vnd-ms.dds"),
)
_RIFF, _WEBP, _AVIF = b"RIFF", b"WEBP", b"ftypavif"


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture as a file has it."""

    name: str  # of its file without the extension; empty for a data URI
    media_type: str
    data: bytes


def embedded_picture(image: Item, companions: Companions, where: str) -> Picture | str:
    """Return the picture of an image with a URI, or a note why it cannot be embedded."""
    uri: str = image["uri"]
    declared = image.get("mimeType")
    if uri.startswith("data:"):
        return _of_data_uri(uri, declared, where)
    data = companions.read(uri)
    if data is None:
        return f"The picture {uri[:_SHOWN]!r} of {where} is not among the files: the output refers to it as before."
    name = posixpath.splitext(posixpath.basename(unquote(uri).replace("\\", "/")))[0]
    return Picture(name, _media_type(data, declared), data)


def _of_data_uri(uri: str, declared: object, where: str) -> Picture | str:
    head, _, body = uri.partition(",")
    try:
        data = base64.b64decode(unquote(body), validate=True) if head.endswith(";base64") else unquote_to_bytes(body)
    except (binascii.Error, ValueError):
        return f"The picture of {where} is not valid base64: the output has it as the input did."
    named = head.removeprefix("data:").split(";")[0]
    return Picture("", _media_type(data, declared or named), data)


def _media_type(data: bytes, declared: object) -> str:
    """The type of a picture by its first bytes, else the declared one."""
    found = picture_type(data)
    return found or (declared if isinstance(declared, str) and declared else "application/octet-stream")


def picture_type(data: bytes) -> str | None:
    """Return the media type of a picture by its first bytes; None if it is not known."""
    for signature, media_type in _SIGNATURES:
        if data.startswith(signature):
            return media_type
    if data.startswith(_RIFF) and data[8:12] == _WEBP:
        return "image/webp"
    return "image/avif" if data[4:12] == _AVIF else None
