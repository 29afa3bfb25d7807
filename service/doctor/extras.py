"""Which optional dependencies of the product are not installed, by the extras that install them."""

import re
from collections import defaultdict
from importlib.metadata import PackageNotFoundError, distribution, requires

from cleave.version import DISTRIBUTION

_OF_DEVELOPERS = {"audit", "blender-test", "test"}
# A requirement with an extra as its only condition; those with more may not be needed on this machine.
_OPTIONAL = re.compile(r"""([\w.-]+)[^;]*;\s*extra == ["']([\w-]+)["']""")


def missing_extras(name: str = DISTRIBUTION) -> list[str]:
    """Return the extras of a distribution of which a package is not installed.

    Raises
    ------
    PackageNotFoundError
        If the distribution itself is not installed.
    """
    packages: dict[str, list[str]] = defaultdict(list)
    for line in requires(name) or []:
        if found := _OPTIONAL.fullmatch(line):
            packages[found[2]].append(found[1])
    return [extra for extra in sorted(packages.keys() - _OF_DEVELOPERS) if not all(map(_is_installed, packages[extra]))]


def _is_installed(name: str) -> bool:
    try:
        distribution(name)
    except PackageNotFoundError:
        return False
    return True
