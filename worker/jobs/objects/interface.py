"""The interface of object storage, which a folder and a bucket implement.

An object has a key: parts separated by slashes, such as ``jobs/<id>/job.json``. An object is read whole or not at all,
also after a crash during a write, and is durable as soon as the call that wrote it has returned.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Protocol, TypeVar

Item = TypeVar("Item")
Value = TypeVar("Value")


class StoreError(OSError):
    """The storage does not answer or refuses; whether the request was carried out is unknown. A retry may help."""


@dataclass(frozen=True, slots=True)
class ObjectInfo:
    key: str
    size_bytes: int
    modified_at: float  # seconds since 1970

    @property
    def name(self) -> str:
        return name_of(self.key)


def name_of(key: str) -> str:
    """Return the last part of a key."""
    return key.rpartition("/")[2]


class ObjectStorage(Protocol):
    """Objects by key. Every method raises an OSError if it fails; a remote storage raises a StoreError."""

    @property
    def survives_fork(self) -> bool:
        """Whether a forked child process can use this storage as well."""

    @property
    def poll_interval_s(self) -> float:
        """Shortest interval at which a caller should poll for a change; 0 if reads are as cheap as those of a file."""

    def create(self, key: str, data: bytes, *, durable: bool = True) -> bool:
        """Write an object unless there is one; return True if this call has written the object that is there now.

        Of several concurrent writers of different bytes exactly one gets True. If the object is not ``durable``, it may
        be absent after a crash of the machine, until ``sync`` was called for it.
        """

    def put(self, key: str, data: bytes, *, durable: bool = True) -> None:
        """Write or replace an object; one that is not ``durable`` may also be empty after a crash of the machine."""

    def put_file(self, key: str, path: Path) -> None:
        """Write or replace an object with the contents of a file, which may be moved.

        After a crash of the machine it may be absent, but not incomplete, until ``sync`` was called for it or for
        another object beside it.
        """

    def copy(self, key: str, target: str) -> None:
        """Write or replace an object with the contents of another one; a folder shares the bytes of both if it can.

        Raises
        ------
        FileNotFoundError
            If there is no object to copy.
        """

    def get(self, key: str) -> bytes | None:
        """Return the bytes of a small object; None if there is none."""

    def open(self, key: str) -> BinaryIO:
        """Open an object of any size as a seekable file.

        Raises
        ------
        FileNotFoundError
            If there is none.
        """

    def exists(self, key: str) -> bool: ...

    def delete(self, key: str) -> None:
        """Remove an object, if there is one."""

    def keys_below(self, folder: str, after: str = "", limit: int | None = None) -> list[str]:
        """Return the keys that begin with the folder and a slash, in order: those after a key, at most ``limit``.

        The cost depends on the number of keys that are returned, if the keys are spread over folders that each have
        a limited number of entries; a bucket needs no such folders.
        """

    def list_below(self, folder: str, after: str = "", limit: int | None = None) -> list[ObjectInfo]:
        """Return the objects with the keys that ``keys_below`` returns."""

    def walk(self, folder: str) -> Iterator[str]:
        """Yield the keys that begin with the folder and a slash, in any order and without holding all of them.

        Of objects that are written or deleted meanwhile some may be missing.
        """

    def each(self, work: Callable[[Item], Value], items: Iterable[Item]) -> list[Value]:
        """Apply a function to some items and return the results in order; a remote storage uses several threads."""

    def presigned_url(self, key: str, valid_s: float) -> str | None:
        """Return a URL from which anyone can read an object for a time; None if the storage has none."""

    def sync(self, keys: Iterable[str]) -> None:
        """Make objects durable that were written without ``durable``; some of them may be deleted by now."""

    def check_writable(self) -> None:
        """Raise an OSError if objects cannot be written, or if ``create`` replaces an object."""
