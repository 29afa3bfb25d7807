"""Tools for jobs and their parts."""

import json
from dataclasses import dataclass
from typing import Annotated, Any

from mcp.server.mcpserver.exceptions import ToolError
from pydantic import Field

from cleave.client import AsyncClient, Job
from service.mcp.calls import Call, Connect, JobId, edited_text, text_of

LONGEST_WAIT_S = 45.0  # many clients give a tool a minute; set by hand
_MOST_JOBS = 20
_MOST_NAMES = 1000  # operations of an edit

PartNumber = Annotated[int, Field(ge=0, description="The number of a part, as look and list_parts show it.")]


async def job_text(client: AsyncClient, job_id: str, wait_s: float) -> str:
    """Return the state of a job, after its end or after some seconds."""
    return text_of(_state(await client.job(job_id, wait_s=wait_s)))


def _state(job: Job) -> dict[str, Any]:
    state = {
        "job_id": job.id,
        "status": job.status,
        "file_name": job.file_name,
        "faces": job.faces,
        "revision": job.document.get("revision"),
        "automatic_parts": job.automatic_segments,
        "most_parts": job.max_segments,
    }
    if job.error is not None:
        state["error"] = job.error.message
    if job.status == "succeeded":
        state["next"] = "Call look to see the parts with their numbers."
    elif not job.has_ended:
        state |= {"progress": job.progress, "next": "Call job_status with wait_s to wait for the end."}
    return state


@dataclass(frozen=True, slots=True)
class JobTools:
    """The parts of a job are always those of its newest revision."""

    connect: Connect

    async def list_jobs(self, call: Call) -> str:
        """List the newest jobs of the caller, at most 20: job_id, status, file_name, faces and numbers of parts."""
        async with self.connect(call) as client:
            jobs: list[dict[str, Any]] = []
            async for job in client.jobs():
                jobs.append({name: value for name, value in _state(job).items() if name != "next"})
                if len(jobs) == _MOST_JOBS:
                    break
        return text_of({"jobs": jobs})

    async def job_status(
        self,
        call: Call,
        job_id: JobId,
        wait_s: Annotated[
            float, Field(ge=0, le=LONGEST_WAIT_S, description="Seconds to wait for the end of the job.")
        ] = 0.0,
    ) -> str:
        """Return the state of a job: queued, running, succeeded, failed (with the reason) or canceled.

        automatic_parts is the number of parts that Cleave has chosen; set_level accepts 1 to most_parts. revision
        counts the edits; 0 is the automatic result.
        """
        async with self.connect(call) as client:
            return await job_text(client, job_id, wait_s)

    async def list_parts(self, call: Call, job_id: JobId) -> str:
        """List the parts with their measurements, in the unit of the mesh.

        For each part: number, name (empty for none), color as in the picture, number of faces, area, volume (null if
        the part cannot be closed), centre (x, y, z), extents (the edges of the box around it, the longest first), and
        touches (the numbers of the parts that it borders on). copies has groups of equal parts, such as the legs of a
        table, so that they can get one name. This measures the whole mesh: on large ones it takes some seconds.
        """
        async with self.connect(call) as client:
            listed = json.loads(await client.content(job_id, "parts", revision="latest"))
        return text_of(
            {
                "unit": listed["unit"],
                "parts": [_measured(part) for part in listed["parts"]],
                "copies": [[copy["part"] for copy in group["copies"]] for group in listed["repeats"]],
            }
        )

    async def set_level(
        self,
        call: Call,
        job_id: JobId,
        parts: Annotated[int | None, Field(ge=1, description="The number of parts, 1 to most_parts.")] = None,
        granularity: Annotated[
            float | None,
            Field(ge=0, le=1, description="In place of parts: 0 is coarse, 0.5 the automatic number, 1 fine."),
        ] = None,
    ) -> str:
        """Start again from the automatic cut, with a number of parts or, if none is given, the automatic number.

        Do this before you name parts: names and edits are not carried over. Nothing is lost: restore_revision brings
        the earlier parts back. Returns the new parts.
        """
        level = {"segments": parts, "granularity": granularity}
        given = {name: value for name, value in level.items() if value is not None}
        operation = {"op": "restore", "revision": 0} | ({"level": given} if given else {})
        return await self._edit(call, job_id, [operation])

    async def merge_parts(
        self,
        call: Call,
        job_id: JobId,
        parts: Annotated[list[PartNumber], Field(min_length=2, max_length=10_000)],
    ) -> str:
        """Make several parts one part, with the number, the name and the colour of the first. Returns the new parts."""
        return await self._edit(call, job_id, [{"op": "merge", "parts": parts}])

    async def name_parts(
        self,
        call: Call,
        job_id: JobId,
        names: Annotated[
            dict[str, str],
            Field(
                min_length=1,
                max_length=_MOST_NAMES,
                description='Names by the numbers of parts, such as {"0": "seat", "1": "left front leg"}; an empty '
                "name removes one.",
            ),
        ],
    ) -> str:
        """Name parts, all in one call. Equal parts may have equal names. Names are in every file that is downloaded.

        Look from several sides first, so that you have seen every part. Returns the parts with their names.
        """
        wrong = [number for number in names if not number.isdecimal()]
        if wrong:
            raise ToolError(
                f"{wrong[0]!r} is no number of a part: names are given by numbers, such as {{'0': 'seat'}}."
            )
        operations = [
            {"op": "name", "part": int(number), "name": name}
            if name.strip()
            else {"op": "delete_name", "part": int(number)}
            for number, name in names.items()
        ]
        return await self._edit(call, job_id, operations)

    async def restore_revision(
        self,
        call: Call,
        job_id: JobId,
        revision: Annotated[int, Field(ge=0, description="Its number; 0 is the automatic result.")],
    ) -> str:
        """Undo: make the parts what they were in an earlier revision. It becomes the newest one; nothing is lost."""
        return await self._edit(call, job_id, [{"op": "restore", "revision": revision}])

    async def _edit(self, call: Call, job_id: str, operations: list[dict[str, Any]]) -> str:
        async with self.connect(call) as client:
            return edited_text(await client.edit(job_id, operations))


def _measured(part: dict[str, Any]) -> dict[str, Any]:
    kept = {name: part[name] for name in ("number", "name", "color", "faces", "area", "volume", "centre")}
    touched = [neighbour["part"] for neighbour in part["neighbours"]]
    return kept | {"extents": part["box"]["extents"], "touches": touched}
