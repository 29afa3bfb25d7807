"""Names of segments that a client gives for a file."""

import hashlib
import re
from typing import Annotated

from fastapi import Depends, Query

from segcore.errors import InvalidParameters

_NAME = re.compile(r"([0-9]{1,5}):(\S.*)", re.DOTALL)
_MAX_LENGTH = 200  # characters, with the label; set by hand


async def _names(
    name: Annotated[
        list[Annotated[str, Query(max_length=_MAX_LENGTH)]] | None,
        Query(
            max_length=1000,
            description="The name of a segment in the file, LABEL:NAME; may be repeated for other labels.",
            examples=[["3:left arm"]],
        ),
    ] = None,
) -> dict[int, str]:
    found = [_NAME.fullmatch(text) for text in name or []]
    if not all(found):
        raise InvalidParameters("A name is given as LABEL:NAME, such as 3:left arm.")
    return {int(match[1]): match[2] for match in found if match}


PartNames = Annotated[dict[int, str], Depends(_names)]


def names_digest(names: dict[int, str]) -> str:
    """Return the query part that identifies a set of names, empty if there are none."""
    return f"&names={hashlib.sha256(repr(sorted(names.items())).encode()).hexdigest()}" if names else ""
