"""The operator that fetches parts which were corrected or named on the page of the server."""

from collections.abc import Mapping
from functools import partial

import bpy

from ..errors import CleaveError
from ..parts import Parts, said
from ..results import Corrected, corrected_on
from ..scene.reading import Subject
from ..scene.record import record
from ..server import Server
from ..work import Solve
from .computing import RESULTS, Computing
from .preferences import preferences, server


class FetchOperator(Computing, bpy.types.Operator):
    """Fetch the parts of the selected objects as they were corrected and named on the page of the server"""

    bl_idname = "object.cleave_fetch"
    bl_label = "Fetch Corrected Parts"
    bl_options = {"REGISTER", "UNDO"}

    with_modifiers = False  # the shape does not matter

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        self.draw_outputs()

    def tasks(self, context: bpy.types.Context, found: list[Subject]) -> Mapping[str, Solve]:
        at = server(preferences(context))
        return {
            key: partial(corrected_on, at, job, subject.polygons.triangle_count)
            for subject in found
            for key, job in [self._key_and_job(at, subject)]
            if key not in RESULTS
        }

    def refresh(self, context: bpy.types.Context, found: list[Subject]) -> None:
        at = server(preferences(context))
        for subject in found:
            RESULTS.discard(self._key_and_job(at, subject)[0])

    def parts(self, context: bpy.types.Context, subject: Subject) -> Parts:
        key, _ = self._key_and_job(server(preferences(context)), subject)
        result: Corrected = RESULTS[key]
        return said(result.revision.labels, result.revision.parts)

    @staticmethod
    def _key_and_job(at: Server, subject: Subject) -> tuple[str, str]:
        """Return the name of the result and the job of a mesh.

        Raises
        ------
        CleaveError
            If the mesh was not segmented on this server, or was changed since.
        """
        known = record(subject.mesh)
        if "job" not in known or known.get("server") != at.url:
            raise CleaveError(f"{subject.name} was not segmented on {at.url}: use Find Parts with this server first.")
        if known.get("topology") != subject.topology:
            raise CleaveError(f"{subject.name} has other faces than those that were sent: use Find Parts again.")
        return f"revision {at.url} {known['job']}", str(known["job"])
