"""Names of a package that are imported when they are first used."""

import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from importlib.util import LazyLoader, find_spec, module_from_spec
from typing import Any


def lazy_names(package: str, modules: Mapping[str, Sequence[str]]) -> Callable[[str], Any]:
    """Return the ``__getattr__`` of a package that imports its public names from its modules.

    Parameters
    ----------
    modules : the names by the module that defines them, which is given without the package.
    """
    module_of = {name: f"{package}.{module}" for module, names in modules.items() for name in names}

    def get(name: str) -> Any:
        if name not in module_of:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(module_of[name]), name)
        setattr(sys.modules[package], name, value)  # the next time it is found without this function
        return value

    return get


class called_later:  # noqa: N801  # it is used like a function
    """A function that imports another one, ``package.module:name``, when it is called."""

    def __init__(self, place: str) -> None:
        self._module, _, self._name = place.partition(":")

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        return self.load()(*arguments, **options)

    def load(self) -> Callable[..., Any]:
        """Import the other function, and return it."""
        function: Callable[..., Any] = getattr(import_module(self._module), self._name)
        return function


def import_later(name: str) -> None:
    """Import a submodule, ``package.module``, when one of its attributes is first used.

    It is already an attribute of its package, so that ``from package import *`` does not import it.
    """
    spec = None if name in sys.modules else find_spec(name)
    if spec is None or spec.loader is None:
        return
    spec.loader = loader = LazyLoader(spec.loader)
    module = sys.modules[name] = module_from_spec(spec)
    loader.exec_module(module)
    package, _, attribute = name.rpartition(".")
    setattr(sys.modules[package], attribute, module)
