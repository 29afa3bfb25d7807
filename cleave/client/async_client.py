"""The client for asyncio."""

import asyncio
import os
from collections.abc import AsyncIterator, Mapping, Sequence
from types import TracebackType
from typing import Any, Literal

import httpx
from numpy.typing import ArrayLike

from cleave.client import edit_flows, flows
from cleave.client.connection import (
    CHUNK_BYTES,
    Companions,
    Connection,
    Mesh,
    async_chunks,
    partial_path,
    submission_of,
    texts,
)
from cleave.client.documents import Edited, Job, Revision, Segmentation, Status
from cleave.client.flows import Call, Flow, Value


class AsyncClient:
    """The same as :class:`cleave.client.Client`, with methods to be awaited."""

    def __init__(
        self,
        url: str = "http://127.0.0.1:8000",
        api_key: str | None = None,
        *,
        timeout_s: float = 60.0,
        retries: int = 4,
        transport: httpx.AsyncBaseTransport | None = None,
    ) -> None:
        self._connection = Connection(url, api_key, timeout_s, retries)
        self._http = httpx.AsyncClient(
            base_url=self._connection.url, headers=self._connection.headers, transport=transport
        )

    async def __aenter__(self) -> "AsyncClient":
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    async def close(self) -> None:
        await self._http.aclose()

    async def submit(
        self,
        mesh: Mesh,
        *,
        companions: Companions = (),
        parameters: Mapping[str, object] | None = None,
        format: str | None = None,  # noqa: A002
        unit: str | None = None,
        up: str | None = None,
        webhook: str | None = None,
        idempotency_key: str | None = None,
        recompute: bool = False,
    ) -> Job:
        """Submit a mesh and return its job at once.

        Parameters
        ----------
        companions : files that the mesh file refers to, such as materials, buffers and pictures; a list of paths, or a
            mapping from their paths relative to the mesh file. The server opens no others.
        unit, up : the unit of the coordinates, such as ``mm``, and the axis that points up, ``y`` or ``z``, if the file
            does not name them.
        """
        submission = submission_of(
            mesh,
            companions=companions,
            parameters=parameters,
            format=format,
            unit=unit,
            up=up,
            webhook=webhook,
            idempotency_key=idempotency_key,
            recompute=recompute,
        )
        return await self._run(flows.submit(submission))

    async def segment(
        self,
        mesh: Mesh,
        *,
        companions: Companions = (),
        segments: int | None = None,
        granularity: float | None = None,
        parameters: Mapping[str, object] | None = None,
        format: str | None = None,  # noqa: A002
        unit: str | None = None,
        up: str | None = None,
    ) -> Segmentation:
        """Submit a mesh and wait for its labels.

        Parameters
        ----------
        companions : files that the mesh file refers to, as in :meth:`submit`.
        segments : number of segments; None for the automatic number.
        granularity : 0 (coarse) to 1 (fine), in place of a number of segments.
        unit, up : as of ``submit``.
        """
        submission = submission_of(mesh, companions=companions, parameters=parameters, format=format, unit=unit, up=up)
        return await self._run(flows.segment(submission, flows.level_of(segments, granularity)))

    async def version(self) -> str:
        """Return the version of the software of the server."""
        return await self._run(flows.version())

    async def job(self, job_id: str, *, wait_s: float = 0.0) -> Job:
        """Return a job; with ``wait_s`` the server answers when the job has ended, or after that time."""
        return await self._run(flows.get(job_id, wait_s))

    async def wait(self, job_id: str) -> Job:
        """Wait until a job has ended."""
        return await self._run(flows.wait(job_id))

    async def jobs(self, status: Status | None = None) -> AsyncIterator[Job]:
        """Iterate over all jobs, newest first."""
        cursor: str | None = None
        while True:
            jobs, cursor = await self._run(flows.page(status, cursor))
            for job in jobs:
                yield job
            if cursor is None:
                return

    async def labels(
        self,
        job: Job,
        segments: int | None = None,
        *,
        granularity: float | None = None,
        revision: int | Literal["latest"] | None = None,
    ) -> Segmentation:
        """Return the labels of a job that has succeeded, at a level or of a revision."""
        return await self._run(flows.labels(job, flows.level_of(segments, granularity, revision)))

    async def edit(
        self,
        job_id: str,
        operations: Sequence[Mapping[str, Any]],
        *,
        base: int | None = None,
        level: Mapping[str, Any] | None = None,
        preview: bool = False,
    ) -> Edited:
        """Edit the parts of a job, which makes its next revision.

        Parameters
        ----------
        operations : as in the body of ``POST /v1/jobs/{job_id}/edits``.
        base : the revision that is edited; None for the newest one, whoever has made it.
        level : the level of the automatic result that is edited if there is no revision yet.
        preview : do not store the parts.
        """
        return await self._run(edit_flows.edit(job_id, operations, base, level, preview))

    async def put_labels(self, job_id: str, labels: ArrayLike, *, base: int | None = None) -> Edited:
        """Store labels (F,) that were made elsewhere as the next revision, after ``base`` as in :meth:`edit`."""
        return await self._run(edit_flows.put_labels(job_id, labels, base))

    async def revisions(self, job_id: str) -> list[Revision]:
        """Return the revisions of a job, newest first."""
        return await self._run(edit_flows.revisions(job_id))

    async def hierarchy(self, job_id: str) -> dict[str, Any]:
        """Return the tree of cuts as the API documents it."""
        return await self._run(flows.hierarchy(job_id))

    async def download(self, job_id: str, result: str, target: str | os.PathLike[str], **params: object) -> None:
        """Save a result, such as ``model.glb``, in a file, which is written completely or not at all.

        ``params`` are those of the query, such as ``revision="latest"``.
        """
        path = f"/v1/jobs/{job_id}/{result}"
        partial = partial_path(target)
        try:
            async with self._http.stream(
                "GET", path, params=texts(params), timeout=self._connection.timeout_s
            ) as response:
                if response.is_error:
                    await response.aread()
                    raise flows.refusal(response)
                with partial.open("wb") as file:
                    async for chunk in response.aiter_bytes(CHUNK_BYTES):
                        await asyncio.to_thread(file.write, chunk)
        except httpx.TransportError as error:
            raise self._connection.failure(None, error) from error
        else:
            os.replace(partial, target)
        finally:
            partial.unlink(missing_ok=True)

    async def content(self, job_id: str, result: str, **params: object) -> bytes:
        """Return a result, such as ``preview.png``, as bytes in memory; ``params`` as of :meth:`download`."""
        return await self._run(flows.content(job_id, result, texts(params)))

    async def cancel(self, job_id: str) -> Job:
        return await self._run(flows.cancel(job_id))

    async def delete(self, job_id: str) -> None:
        await self._run(flows.delete(job_id))

    async def _run(self, flow: Flow[Value]) -> Value:
        try:
            call = next(flow)
            while True:
                call = flow.send(await self._send(call))
        except StopIteration as end:
            value: Value = end.value
            return value

    async def _send(self, call: Call) -> httpx.Response:
        attempt = 0
        while True:
            response, failure = None, None
            try:
                response = await self._http.send(self._connection.request(self._http, call, async_chunks(call.body)))
                if not response.is_error:
                    return response
            except httpx.TransportError as error:
                failure = error
            pause_s = self._connection.pause_s(attempt, response)
            if pause_s is None:
                raise self._connection.failure(response, failure)
            attempt += 1
            await asyncio.sleep(pause_s)
