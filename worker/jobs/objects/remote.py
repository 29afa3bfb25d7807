"""Objects in a bucket of S3, Google Cloud Storage or Azure, or in the memory of this process."""

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

_AT_A_TIME = 16
_PIECE_BYTES = 4 * 2**20
_LISTED_AT_A_TIME = 1000


class RemoteObjects:
    """The objects of a bucket, through clients that give up before a caller of the API does.

    A process that has used it cannot go on using it after a fork: its connections live in threads.
    """

    survives_fork = False
    poll_interval_s = 0.5

    def __init__(self, bucket: Bucket, spool: Path) -> None:
        """``spool`` is a folder of this machine for what is being downloaded."""
        self._bucket = bucket
        self._spool = spool
        self._pool: ThreadPoolExecutor | None = None
        self._creates_once = False  # whether that was seen
        spool.mkdir(mode=0o700, parents=True, exist_ok=True)

    def create(self, key: str, data: bytes) -> bool:
        try:
            with _translated_errors(), _a_bucket_that_is_there():
                self._bucket.writes.put(key, data, mode="create", use_multipart=False)
        except AlreadyExistsError:
            return self.get(key) == data  # a request whose answer was lost is sent again, and finds its own object
        return True

    def put(self, key: str, data: bytes, *, durable: bool = True) -> None:  # noqa: ARG002
        with _translated_errors(), _a_bucket_that_is_there():
            self._bucket.writes.put(key, data, use_multipart=False)

    def put_file(self, key: str, path: Path) -> None:
        path.stat()  # a file that is not there is another matter than a bucket that is not
        with _translated_errors(), _a_bucket_that_is_there():
            self._bucket.transfers.put(key, path)

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

    def list_below(self, folder: str) -> list[ObjectInfo]:
        return self._list(folder)

    def each(self, work: Callable[[Item], Value], items: Iterable[Item]) -> list[Value]:
        """As promised; the work must not call ``each`` itself, or all threads may wait for each other."""
        if self._pool is None:
            self._pool = ThreadPoolExecutor(_AT_A_TIME, "store")
        return list(self._pool.map(work, items))

    def presigned_url(self, key: str, valid_s: float) -> str | None:
        return self._bucket.sign(key, timedelta(seconds=valid_s))

    def check_writable(self) -> None:
        probe = f"probe/{secrets.token_hex(16)}"
        if self.create(probe, b"first") and not self._creates_once:
            if self.create(probe, b"second"):
                raise StoreError("The store creates an object twice: use one that has conditional writes.")
            self._creates_once = True
        self.delete(probe)

    def _list(self, folder: str, after: str = "", limit: int | None = None) -> list[ObjectInfo]:
        found: list[ObjectInfo] = []
        with _translated_errors(), _a_bucket_that_is_there():
            for part in self._bucket.reads.list(folder, offset=after or None, chunk_size=limit or _LISTED_AT_A_TIME):
                found += [ObjectInfo(one["path"], one["size"], one["last_modified"].timestamp()) for one in part]
                if limit is not None and len(found) >= limit:
                    break
        return sorted(found, key=lambda one: one.key)[:limit]


@contextmanager
def _a_bucket_that_is_there() -> Iterator[None]:
    try:
        yield
    except FileNotFoundError as error:
        raise StoreError("There is no such bucket: make it, or mend CLEAVE_STORE_URL.") from error


@contextmanager
def _translated_errors() -> Iterator[None]:
    """Whatever a client of a bucket raises becomes one of the errors that the seam knows."""
    try:
        yield
    except (FileNotFoundError, AlreadyExistsError, StoreError):
        raise
    except (BaseError, OSError) as error:
        raise StoreError(f"The store does not answer: {str(error).strip().splitlines()[0]}") from error
