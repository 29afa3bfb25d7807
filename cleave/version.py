"""The version of the installed distribution."""

from importlib.metadata import PackageNotFoundError, version

DISTRIBUTION = "cleave-mesh"  # `cleave` on PyPI is another project


def installed_version() -> str:
    """Return the version of the installed distribution; ``0+checkout`` if the packages are not installed."""
    try:
        return version(DISTRIBUTION)
    except PackageNotFoundError:
        return "0+checkout"


def extra_command(extra: str) -> str:
    """Return the shell command that installs an optional dependency of this project."""
    return f"pip install '{DISTRIBUTION}[{extra}]'"
