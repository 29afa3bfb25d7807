"""Names of segments, as a client gives them for a file."""

import hashlib
import re
from typing import Annotated

from fastapi import Depends, Query

from segcore.errors import InvalidParameters

_NAME = re.compile(r"([0-9]{1,5}):(\S.*)", re.DOTALL)
_LONGEST = 200  # characters, with the label


async def _names(
    name: Annotated[
        list[Annotated[str, Query(max_length=_LONGEST)]] | None,
        Query(
            max_length=1000,
            description="What a segment is called in the file, LABEL:NAME; may be given again for other labels.",
            examples=[["3:left arm"]],
        ),
    ] = None,
) -> dict[int, str]:
    found = [_NAME.fullmatch(text) for text in name or []]
    if not all(found):
        raise InvalidParameters("A name is given as LABEL:NAME, such as 3:left arm.")
    return {int(match[1]): match[2] for match in found if match}


PartNames = Annotated[dict[int, str], Depends(_names)]


def named(names: dict[int, str]) -> str:
    """What names add to the address of a file: the same for the same names, nothing for none."""
    return f"&names={hashlib.sha256(repr(sorted(names.items())).encode()).hexdigest()}" if names else ""
