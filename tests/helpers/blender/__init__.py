"""Runs the extension in Blender, the wheel ``bpy`` of the extra ``blender-test``."""
