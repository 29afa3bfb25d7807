"""The seam between the store and the place where its bytes are: a folder of this machine, or a bucket.

An object has a name, its key: parts with slashes between them, such as ``jobs/<id>/job.json``. What is read under a key
is whole, whatever was running when a process or a machine died, and durable as soon as the call that wrote it returns.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Protocol, TypeVar

Item = TypeVar("Item")
Value = TypeVar("Value")


class StoreError(OSError):
    """The store does not answer or refuses: nothing is known about what was asked. Trying again later may help."""


@dataclass(frozen=True, slots=True)
class ObjectInfo:
    key: str
    size_bytes: int
    modified_at: float  # seconds since 1970

    @property
    def name(self) -> str:
        return name_of(self.key)


def name_of(key: str) -> str:
    """The last part of a key."""
    return key.rpartition("/")[2]


class ObjectStorage(Protocol):
    """Named objects. Every method raises an OSError, a StoreError where it is a remote one, when it cannot be done."""

    @property
    def is_local(self) -> bool:
        """Whether the objects are files of this machine, which also a forked process can read."""

    @property
    def look_s(self) -> float:
        """The pause between two looks for news that this place bears from many callers; 0 where looking is cheap."""

    def create(self, key: str, data: bytes) -> bool:
        """Write an object unless there is one; whether the one that is there now has these bytes from this writer.

        Of many writers at once with different bytes exactly one gets True.
        """

    def put(self, key: str, data: bytes, *, durable: bool = True) -> None:
        """Write an object, or another one in its place; one that need not be durable may be empty after a crash."""

    def put_file(self, key: str, path: Path) -> None:
        """Write an object with the bytes of a file, which may be gone afterwards."""

    def get(self, key: str) -> bytes | None:
        """The bytes of a small object; None where there is none."""

    def open(self, key: str) -> BinaryIO:
        """An object of any size, to be read in any order.

        Raises
        ------
        FileNotFoundError
            Where there is none.
        """

    def exists(self, key: str) -> bool: ...

    def delete(self, key: str) -> None:
        """Remove an object; without effect where there is none."""

    def keys_below(self, folder: str, after: str = "", limit: int | None = None) -> list[str]:
        """The first keys that begin with the folder and a slash and come after another, in their order."""

    def list_below(self, folder: str) -> list[ObjectInfo]:
        """All objects whose keys begin with the folder and a slash, in order of keys."""

    def each(self, work: Callable[[Item], Value], items: Iterable[Item]) -> list[Value]:
        """Do something for each of some items, several at a time where that is quicker, and keep their order."""

    def presigned_url(self, key: str, valid_s: float) -> str | None:
        """An address from which anybody can read an object for a while; None where this place has none."""

    def check_writable(self) -> None:
        """Raise an OSError where objects cannot be written, or ``create`` is not what it must be."""
