"""The timer of the operators, whose events Blender does not have without a window; run inside Blender."""

import sys
import types
from typing import Any

import bpy
import numpy as np
from facts import ADDON, select
from models import five_models


def beside_the_interface() -> dict[str, Any]:
    """The timer of the operator: it waits, can be stopped, and writes at the end; Blender has no events here."""
    computing = sys.modules[f"{ADDON}.ui.computing"]
    errors = sys.modules[f"{ADDON}.errors"]
    parts = sys.modules[f"{ADDON}.parts"]
    table = five_models()[0]
    select(table)

    class Result:
        faces = 1

    class Probe(computing.Computing):
        face_sets = materials = groups = separate = False
        attribute = True
        names = ""
        options = types.SimpleNamespace(is_repeat=False)
        fails = False

        def __init__(self) -> None:
            self.said = []

        def report(self, kinds: set[str], text: str) -> None:
            self.said.append([*kinds, text])

        def tasks(self, *_: Any) -> dict[str, Any]:
            return {} if "probe" in computing.RESULTS else {"probe": self.solve}

        def solve(self, watch: Any) -> Result:
            watch.pause(0.3)
            if self.fails:
                raise errors.CleaveError("No luck: try again.")
            return Result()

        def parts(self, _: Any, subject: Any) -> Any:
            return parts.unnamed(np.zeros(subject.polygons.triangle_count, dtype=np.int32), 1)

        def start(self) -> None:
            computing.RESULTS.discard("probe")
            self._work = computing.Work(self.tasks(), 60.0)
            self._work.start()
            self._timer = bpy.context.window_manager.event_timer_add(0.1, window=bpy.context.window)

        def see(self, kind: str, value: str = "") -> list[str]:
            return sorted(self.modal(bpy.context, types.SimpleNamespace(type=kind, value=value)))

        def wait(self) -> list[str]:
            self._work.join()
            return self.see("TIMER")

    seen = {}
    for name in ("done", "stopped", "failed", "changed"):
        probe = Probe()
        probe.fails = name == "failed"
        probe.start()
        during = [probe.see("TIMER"), probe.see("MOUSEMOVE")]
        if name == "stopped":
            during.append(probe.see("ESC", "PRESS"))
        if name == "changed":
            probe.tasks = lambda *_: {"another mesh": None}
        seen[name] = [during, probe.wait(), probe.said]
    return seen
