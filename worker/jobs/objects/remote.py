"""Object storage in a bucket of S3, Google Cloud Storage or Azure, or in the memory of this process."""

import secrets
import tempfile
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from datetime import timedelta
from pathlib import Path
from typing import BinaryIO, cast

from obstore.exceptions import AlreadyExistsError, BaseError

from worker.jobs.objects.buckets import Bucket
from worker.jobs.objects.interface import Item, ObjectInfo, StoreError, Value

_THREADS = 16  # concurrent requests of ``each``; set by hand
_PIECE_BYTES = 4 * 2**20  # of a download, in memory; set by hand
_PAGE_KEYS = 1000  # the most that S3 lists in one request


class RemoteObjects:
    """The objects of a bucket. After a fork the child process cannot use it, as its connections live in threads."""

    survives_fork = False
    poll_interval_s = 0.5  # a request costs time and money; set by hand

    def __init__(self, bucket: Bucket, spool: Path) -> None:
        """``spool`` is a folder of this machine for downloads."""
        self._bucket = bucket
        self._spool = spool
        self._pool: ThreadPoolExecutor | None = None
        self._creates_once = False  # whether check_writable has found so
        spool.mkdir(mode=0o700, parents=True, exist_ok=True)

    def create(self, key: str, data: bytes, *, durable: bool = True) -> bool:  # noqa: ARG002
        try:
            with _translated_errors(), _missing_bucket_reported():
                self._bucket.writes.put(key, data, mode="create", use_multipart=False)
        except AlreadyExistsError:
            return self.get(key) == data  # if an answer was lost, the request is repeated and finds its own object
        return True

    def put(self, key: str, data: bytes, *, durable: bool = True) -> None:  # noqa: ARG002
        with _translated_errors(), _missing_bucket_reported():
            self._bucket.writes.put(key, data, use_multipart=False)

    def put_file(self, key: str, path: Path) -> None:
        path.stat()  # a FileNotFoundError below then means that there is no bucket
        with _translated_errors(), _missing_bucket_reported():
            self._bucket.transfers.put(key, path)

    def copy(self, key: str, target: str) -> None:
        with _translated_errors():
            self._bucket.transfers.copy(key, target)

    def get(self, key: str) -> bytes | None:
        with suppress(FileNotFoundError), _translated_errors():
            return bytes(self._bucket.reads.get(key).bytes())
        return None

    def open(self, key: str) -> BinaryIO:
        with _translated_errors():
            pieces = self._bucket.transfers.get(key).stream(min_chunk_size=_PIECE_BYTES)
        file = cast(BinaryIO, tempfile.TemporaryFile(dir=self._spool))  # noqa: SIM115  # the caller closes it
        try:
            with _translated_errors():
                for piece in pieces:
                    file.write(piece)
            file.seek(0)
        except BaseException:
            file.close()
            raise
        return file

    def exists(self, key: str) -> bool:
        with suppress(FileNotFoundError), _translated_errors():
            self._bucket.reads.head(key)
            return True
        return False

    def delete(self, key: str) -> None:
        with suppress(FileNotFoundError), _translated_errors():
            self._bucket.writes.delete(key)

    def keys_below(self, folder: str, after: str = "", limit: int | None = None) -> list[str]:
        return [one.key for one in self._list(folder, after, limit)]

    def list_below(self, folder: str, after: str = "", limit: int | None = None) -> list[ObjectInfo]:
        return self._list(folder, after, limit)

    def walk(self, folder: str) -> Iterator[str]:
        after = ""
        while keys := self.keys_below(folder, after, _PAGE_KEYS):
            yield from keys
            after = keys[-1]

    def each(self, work: Callable[[Item], Value], items: Iterable[Item]) -> list[Value]:
        """Use threads; ``work`` must not call ``each`` itself, which could deadlock."""
        if self._pool is None:
            self._pool = ThreadPoolExecutor(_THREADS, "store")
        return list(self._pool.map(work, items))

    def presigned_url(self, key: str, valid_s: float) -> str | None:
        return self._bucket.sign(key, timedelta(seconds=valid_s))

    def sync(self, keys: Iterable[str]) -> None:
        """Do nothing: every object is durable once it is written."""

    def check_writable(self) -> None:
        probe = f"probe/{secrets.token_hex(16)}"
        if self.create(probe, b"first") and not self._creates_once:
            if self.create(probe, b"second"):
                raise StoreError("The store created an object twice: use a store that supports conditional writes.")
            self._creates_once = True
        self.delete(probe)

    def _list(self, folder: str, after: str = "", limit: int | None = None) -> list[ObjectInfo]:
        found: list[ObjectInfo] = []
        with _translated_errors(), _missing_bucket_reported():
            for part in self._bucket.reads.list(folder, offset=after or None, chunk_size=limit or _PAGE_KEYS):
                found += [ObjectInfo(one["path"], one["size"], one["last_modified"].timestamp()) for one in part]
                if limit is not None and len(found) >= limit:
                    break
        return sorted(found, key=lambda one: one.key)[:limit]


@contextmanager
def _missing_bucket_reported() -> Iterator[None]:
    try:
        yield
    except FileNotFoundError as error:
        raise StoreError("There is no such bucket: create it, or correct CLEAVE_STORE_URL.") from error


@contextmanager
def _translated_errors() -> Iterator[None]:
    """Convert the errors of the bucket's clients to those of the interface."""
    try:
        yield
    except (FileNotFoundError, AlreadyExistsError, StoreError):
        raise
    except (BaseError, OSError) as error:
        raise StoreError(f"The store does not answer: {str(error).strip().splitlines()[0]}") from error
