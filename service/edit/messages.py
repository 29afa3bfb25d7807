"""Messages between the service and the processes that edit: a JSON document and bytes, with their lengths before them.

Nothing is pickled, so that a process that a hostile mesh has taken over can send data only.
"""

import json
import struct
from dataclasses import dataclass
from typing import IO, Any

_LENGTHS = struct.Struct("<II")


@dataclass(frozen=True, slots=True, eq=False)
class Message:
    document: dict[str, Any]
    data: bytes = b""


def write_message(target: IO[bytes] | None, message: Message) -> None:
    """Write a message; OSError if the other process has ended."""
    assert target is not None, "the process has pipes"
    text = json.dumps(message.document).encode()
    target.write(_LENGTHS.pack(len(text), len(message.data)) + text)
    target.write(message.data)
    target.flush()


def read_message(source: IO[bytes] | None) -> Message:
    """Read a message.

    Raises
    ------
    EOFError
        If the other process has ended.
    """
    assert source is not None, "the process has pipes"
    text_bytes, data_bytes = _LENGTHS.unpack(_exactly(source, _LENGTHS.size))
    return Message(json.loads(_exactly(source, text_bytes)), _exactly(source, data_bytes))


def _exactly(source: IO[bytes], size: int) -> bytes:
    data = source.read(size)
    if len(data) < size:
        raise EOFError("the other process has ended")
    return data
