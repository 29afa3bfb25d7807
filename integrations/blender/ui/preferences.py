"""Preferences of the extension: where Cleave runs, and how long it may take."""

import sys

import bpy

from ..errors import CleaveError
from ..local import LocalPython
from ..server import Server
from ..web import is_loopback

ADDON = __package__.rpartition(".")[0]


class CleavePreferences(bpy.types.AddonPreferences):
    bl_idname = ADDON

    place: bpy.props.EnumProperty(
        name="Cleave runs",
        items=[
            ("LOCAL", "On This Machine", "In a process of a Python in which Cleave is installed"),
            ("SERVER", "On a Server", "On a Cleave server: the meshes are sent there"),
        ],
        default="LOCAL",
    )
    python: bpy.props.StringProperty(
        name="Python",
        description="The Python in which Cleave is installed; if empty, Blender's own with a folder of packages",
        subtype="FILE_PATH",
    )
    server: bpy.props.StringProperty(name="URL", description="Of the server", default="http://127.0.0.1:8000")
    api_key: bpy.props.StringProperty(
        name="API Key", description="The key for the server, if it requires one", subtype="PASSWORD"
    )
    limit_s: bpy.props.IntProperty(
        name="Time Limit", description="Seconds until a computation is given up", default=600, min=1, soft_max=3600
    )

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "place", expand=True)
        if self.place == "LOCAL":
            layout.prop(self, "python")
            box = layout.box()
            box.label(text="Cleave is installed for this Python by this command, in a terminal:")
            box.label(text=local_python(self).install_command())
        else:
            layout.prop(self, "server")
            layout.prop(self, "api_key")
            if not bpy.app.online_access:
                layout.label(text="Servers on other machines need Allow Online Access, in System > Network.")
        layout.prop(self, "limit_s")


def preferences(context: bpy.types.Context) -> CleavePreferences:
    return context.preferences.addons[ADDON].preferences


def local_python(chosen: CleavePreferences) -> LocalPython:
    """The chosen Python, or Blender's own with packages that Blender itself does not see.

    Packages of Cleave, such as NumPy 2, would replace those that Blender needs if they were installed beside them.
    """
    if chosen.python.strip():
        return LocalPython(bpy.path.abspath(chosen.python.strip()))
    packages = bpy.utils.extension_path_user(ADDON, path="packages", create=True)
    return LocalPython(sys.executable, bpy.app.python_args, packages)


def server(chosen: CleavePreferences) -> Server:
    """The chosen server.

    Raises
    ------
    CleaveError
        If its URL is none, or if it needs the network, which Blender's preferences do not allow.
    """
    found = Server(chosen.server, chosen.api_key)
    if not bpy.app.online_access and not is_loopback(found.url):
        raise CleaveError("Blender is offline: enable Allow Online Access in Preferences > System > Network.")
    return found
