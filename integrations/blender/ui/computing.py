"""What the operators share: they compute what is missing beside the user interface, and then write it."""

import json
from collections.abc import Mapping

import bpy

from ..cache import Cache
from ..errors import CanceledError, CleaveError
from ..parts import Parts
from ..scene.outputs import check_names
from ..scene.reading import Subject, subjects
from ..work import Solve, Work
from .outputs import Outputs
from .preferences import preferences

_INTERVAL_S = 0.1  # between looks at the work
_KEPT_FACES = 20_000_000  # of results that are kept, 4 bytes each

RESULTS = Cache(_KEPT_FACES)


class Computing(Outputs):
    """An operator in two steps: results, which take time, and outputs. A change in the redo panel only writes outputs.

    Operators define ``tasks``, what computes the results that ``RESULTS`` lacks, by their keys, and ``parts`` of a
    subject when they are there.
    """

    names: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})  # of the objects, in JSON; empty for the selection
    with_modifiers = True

    def tasks(self, context: bpy.types.Context, found: list[Subject]) -> Mapping[str, Solve]:
        raise NotImplementedError

    def refresh(self, context: bpy.types.Context, found: list[Subject]) -> None:
        """Forget results that may be out of date; not called for changes in the redo panel."""

    def parts(self, context: bpy.types.Context, subject: Subject) -> Parts:
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Switch to Object Mode")
            return False
        return True  # whatever is selected, which may have changed since the operation that the redo panel shows

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        RESULTS.trim()
        self.names = json.dumps([entry.name for entry in context.selected_objects])
        if bpy.app.background:  # no events, so no timer
            return self.execute(context)
        try:
            found = self._subjects(context)
            self.refresh(context, found)
            tasks = self.tasks(context, found)
        except CleaveError as error:
            return self._fail(error)
        self._work = Work(tasks, preferences(context).limit_s)
        self._work.start()
        self._timer = context.window_manager.event_timer_add(_INTERVAL_S, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type == "ESC" and event.value == "PRESS":
            self._work.watch.stop()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._work.is_alive():
            context.workspace.status_text_set(f"Cleave: {self._work.watch.state} (Esc cancels)")
            return {"PASS_THROUGH"}
        self._end(context)
        return self._attempt(context, self._work)

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends the operator, for example because another file is opened."""
        self._work.watch.stop()
        self._end(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        return self._attempt(context, None)

    def _end(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)

    def _attempt(self, context: bpy.types.Context, work: Work | None) -> set[str]:
        """Write the outputs, after the work that is given or that is still to do."""
        try:
            if work is not None:
                self._keep(work)
            found = self._subjects(context)
            if work is None and not self.options.is_repeat:
                self.refresh(context, found)
            missing = self.tasks(context, found)
            if missing and work is not None:
                raise CleaveError("The mesh was changed while it was segmented: run it again.")
            if missing:
                now = Work(missing, preferences(context).limit_s)
                now.run()
                self._keep(now)
            return self._write(context, found)
        except CleaveError as error:
            return self._fail(error)

    def _subjects(self, context: bpy.types.Context) -> list[Subject]:
        objects = list(context.selected_objects)
        if self.names:  # also for the redo panel, although other objects may have been selected meanwhile
            named = [bpy.data.objects.get(name) for name in json.loads(self.names)]
            objects = [entry for entry in named if entry is not None]
        return subjects(objects, context.evaluated_depsgraph_get(), self.with_modifiers)

    def _keep(self, work: Work) -> None:
        for key, result in work.results.items():
            RESULTS.put(key, result, result.faces)
        if work.error is not None:
            raise work.error

    def _write(self, context: bpy.types.Context, found: list[Subject]) -> set[str]:
        for subject in found:
            check_names(subject.mesh)
        what = found[0].name if len(found) == 1 else f"{len(found)} meshes"
        count = 0
        for subject in found:
            count += self.write(subject, self.parts(context, subject))
            if subject.note:
                self.report({"WARNING"}, subject.note)
        self.report({"INFO"}, f"{what}: {count} {'part' if count == 1 else 'parts'}")
        return {"FINISHED"}

    def _fail(self, error: CleaveError) -> set[str]:
        self.report({"INFO" if isinstance(error, CanceledError) else "ERROR"}, str(error))
        return {"CANCELLED"}
