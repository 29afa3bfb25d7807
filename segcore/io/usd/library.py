"""The package usd-core, which is optional."""

import importlib
from types import SimpleNamespace
from typing import Any

from segcore.errors import MissingPackage

_MODULES = ("Gf", "Kind", "Sdf", "Tf", "Usd", "UsdGeom", "UsdShade", "Vt")


def library() -> Any:
    """Return the modules of pxr that the writers use, by name.

    Raises
    ------
    MissingPackage
        If usd-core is not installed.
    """
    try:
        return SimpleNamespace(**{name: importlib.import_module(f"pxr.{name}") for name in _MODULES})
    except ImportError:
        raise MissingPackage("USD needs the package usd-core: run pip install 'cleave-mesh[usd]'.") from None
