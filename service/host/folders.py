"""Folders that do not exist yet: whether this user could make them."""

import os
from pathlib import Path


def nearest_existing(path: Path) -> Path:
    """Return a path, or the nearest folder above it that exists."""
    return next(one for one in (path, *path.parents) if one.exists())


def can_be_made(folder: Path) -> bool:
    """Whether a folder exists and can be written, or can be made."""
    existing = nearest_existing(folder)
    return existing.is_dir() and os.access(existing, os.W_OK | os.X_OK)
