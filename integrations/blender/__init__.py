"""Cleave in Blender: the parts of meshes as face sets, attributes, materials, vertex groups or objects.

The modules of this folder know nothing of Blender. ``scene`` reads and writes meshes of Blender, ``ui`` has operators,
panel and preferences; both are imported only inside Blender.
"""


def register() -> None:
    from .ui.registration import register_classes

    register_classes()


def unregister() -> None:
    from .ui.registration import unregister_classes

    unregister_classes()
