"""Write the zip of the Blender extension: ``python -m integrations.blender_package FOLDER``.

The same sources give the same bytes. Blender's own ``blender --command extension build`` packs the same files, except
for the licence, which is that of the repository.
"""

import sys
import tomllib
import zipfile
from pathlib import Path

_SOURCES = Path(__file__).with_name("blender")
_LICENCE = Path(__file__).parents[1] / "LICENSE"
_MANIFEST = _SOURCES / "blender_manifest.toml"
_FIRST_DAY = (1980, 1, 1, 0, 0, 0)  # of zip files
_MODE = 0o644 << 16


def members() -> dict[str, Path]:
    """Return the files of the extension by their names in the zip, in alphabetical order."""
    found = {path.relative_to(_SOURCES).as_posix(): path for path in _SOURCES.rglob("*") if _is_packed(path)}
    return dict(sorted({**found, "LICENSE": _LICENCE}.items()))


def pack(folder: Path) -> Path:
    """Write the zip into a folder, which is made if it does not exist, and return its path."""
    manifest = tomllib.loads(_MANIFEST.read_text(encoding="utf-8"))
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / f"{manifest['id']}-{manifest['version']}.zip"
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, path in members().items():
            member = zipfile.ZipInfo(name, _FIRST_DAY)
            member.external_attr = _MODE
            member.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(member, path.read_bytes())
    return target


def _is_packed(path: Path) -> bool:
    return path.suffix in (".py", ".txt", ".toml") and path.is_file()


if __name__ == "__main__":
    sys.stdout.write(f"{pack(Path(sys.argv[1]))}\n")
