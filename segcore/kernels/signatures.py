"""The types of a kernel's arguments as JSON values.

A number is the name of its type (``"int64"``), an array its element type, its dimensions and its layout
(``"float64 2 C"``, followed by ``readonly`` if it is), a tuple a list, and a named tuple an object with the place of
its class (``{"segcore.graphs.surface_graph:Rows": ["int32 1 C", ...]}``).
"""

from importlib import import_module
from operator import attrgetter
from typing import Any

from numba import types

_READ_ONLY = "readonly"


class NoSignature(Exception):  # noqa: N818
    """A type has no JSON value here; the message contains it."""


def encode(kind: types.Type) -> Any:
    """Return the JSON value of a type.

    Raises
    ------
    NoSignature
        If it is another type than those above.
    """
    match kind:
        case types.Number() | types.Boolean():
            return kind.name
        case types.Array(aligned=True):
            words = [kind.dtype.name, str(kind.ndim), kind.layout]
            return " ".join(words if kind.mutable else [*words, _READ_ONLY])
        case types.NamedTuple() | types.NamedUniTuple():
            place = f"{kind.instance_class.__module__}:{kind.instance_class.__qualname__}"
            return {place: [encode(field) for field in kind.types]}
        case types.BaseTuple():
            return [encode(field) for field in kind.types]
    raise NoSignature(str(kind))


def decode(value: Any) -> types.Type:
    """Return the type of a JSON value."""
    if isinstance(value, dict):
        ((place, fields),) = value.items()
        return types.BaseTuple.from_types(tuple(map(decode, fields)), named(place))
    if isinstance(value, list):
        return types.BaseTuple.from_types(tuple(map(decode, value)))
    name, *array = value.split(" ")
    if not array:
        return getattr(types, name)
    return types.Array(getattr(types, name), int(array[0]), array[1], readonly=_READ_ONLY in array)


def named(place: str) -> Any:
    """Return what has a name in a module: ``package.module:name``."""
    module, _, name = place.partition(":")
    return attrgetter(name)(import_module(module))
