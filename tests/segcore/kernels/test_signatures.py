"""Types of arguments as JSON values and back."""

import json
from typing import Any

import numba
import numpy as np
import pytest

from segcore.graphs.surface_graph import Rows
from segcore.kernels.signatures import NoSignature, decode, encode

_INDICES = np.zeros(3, np.int32)
_FROZEN = np.zeros(3, np.uint8)
_FROZEN.flags.writeable = False


@pytest.mark.parametrize(
    "value",
    [
        1,
        2.5,
        True,
        np.float32(1),
        _INDICES,
        _INDICES[::2],
        np.zeros((2, 3), order="F"),
        np.zeros(2, np.bool_),
        _FROZEN,
        Rows(_INDICES, _INDICES, _INDICES),
        (1, 2.5, _INDICES),
        (_INDICES, _INDICES),
    ],
)
def test_a_type_is_the_same_after_it_was_written_and_read(value: Any) -> None:
    kind = numba.typeof(value)
    assert decode(json.loads(json.dumps(encode(kind)))) == kind


def test_other_types_are_refused() -> None:
    with pytest.raises(NoSignature):
        encode(numba.typeof("text"))
