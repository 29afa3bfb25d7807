"""The files that a mesh file refers to: buffers and images of glTF, and the materials of OBJ with their pictures."""

import gzip
import json
import posixpath
import re
import zlib
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path, PurePosixPath
from typing import TypeAlias
from urllib.parse import unquote

from segcore.io.file_sets import FolderCompanions
from segcore.io.limits import ReadLimits
from segcore.io.source import GZIP_MAGIC

Locate: TypeAlias = Callable[[str], Path | None]  # the file at an address, or None if the set does not have it

_CHUNK = 2**20  # bytes that are searched at a time
_MOST_REFERENCES = (
    1000  # of a file; set by hand, more than models have, so that a hostile file is not searched for hours
)
_MOST_WORDS = 16  # of a line that may begin the name at its end
_MOST_LIBRARY_BYTES = 16 * 2**20  # that are searched; materials have a kilobyte each
_LONGEST = 4096  # bytes of an address with its keyword; longer ones are not found
_URI = re.compile(rb'"uri"\s{0,64}:\s{0,64}("(?!data:)(?:[^"\\\x00-\x1f]|\\.){1,2048}")')
_LIBRARY = re.compile(rb"(?:(?<=[\r\n])|\A)[ \t]*mtllib[ \t]+([^\r\n]{1,2048})(?=[\r\n])")
_PICTURE = re.compile(
    rb"(?:(?<=[\r\n])|\A)[ \t]*(?:map_\w+|bump|disp|decal|refl|norm)[ \t]+([^\r\n]{1,2048})(?=[\r\n])", re.IGNORECASE
)


def referenced_files(model: Path, name: str, locate: Locate, limits: ReadLimits | None = None) -> dict[str, Path]:
    """Return the files of a set that a mesh file refers to, directly or through the materials of an OBJ file.

    The file is searched in pieces, not parsed: a damaged one refers to what can be found in it.

    Parameters
    ----------
    model : the mesh file, which may be compressed with gzip.
    name : its name, by whose extension its format is known.
    locate : returns the file of the set at an address relative to the model, or None.
    limits : at most ``max_uncompressed_bytes`` of a compressed file are searched, by default those of ``ReadLimits()``.

    Returns
    -------
    The files by their addresses relative to the model, in the order in which they are named.

    Raises
    ------
    OSError
        If the model cannot be read.
    """
    most = (limits or ReadLimits()).max_uncompressed_bytes
    path = PurePosixPath(name.lower())
    extension = PurePosixPath(path.stem).suffix if path.suffix == ".gz" else path.suffix
    if extension in (".gltf", ".glb"):
        return _located(map(_addresses_of_uri, _found(_URI, model, most)), locate)
    if extension != ".obj":
        return {}
    lines = (_names_in_line(line) for line in _found(_LIBRARY, model, most))
    libraries = _located(chain.from_iterable(lines), locate)
    found = dict(libraries)
    for address, library in libraries.items():
        folder = PurePosixPath(address).parent
        pictures = map(_addresses_in_line, _found(_PICTURE, library, min(most, _MOST_LIBRARY_BYTES)))
        found |= _located(([str(folder / one) for one in names] for names in pictures), locate)
    return found


def neighbours_of(model: Path) -> dict[str, Path]:
    """Return the files that a mesh file refers to in its folder and below; nothing outside of the folder is opened.

    Returns
    -------
    The files by their addresses relative to the model, without links.

    Raises
    ------
    OSError
        If the model cannot be read.
    """
    found = referenced_files(model, model.name, FolderCompanions(model, ReadLimits()).path)
    return {address: file for address, file in found.items() if not address.startswith("../")}


def _located(references: Iterator[list[str]], locate: Locate) -> dict[str, Path]:
    """The first address of each reference that the set has."""
    found: dict[str, Path] = {}
    for addresses in references:
        for address in map(posixpath.normpath, addresses):
            file = found.get(address) or locate(address)
            if file is not None:
                found[address] = file
                break
    return found


def _addresses_of_uri(literal: bytes) -> list[str]:
    try:
        uri = str(json.loads(literal))
    except ValueError:
        return []
    return [unquote(uri)]


def _addresses_in_line(line: bytes) -> list[str]:
    """What may be the name at the end of a line: names may have blanks, and options may stand before them."""
    text = line.decode("utf-8", "replace").strip().replace("\\", "/")
    words = text.split()
    return [text, *(" ".join(words[first:]) for first in range(min(len(words), _MOST_WORDS)))]


def _names_in_line(line: bytes) -> list[list[str]]:
    """What may be the names in a line: one name, which may have blanks, or several without blanks."""
    at_the_end = _addresses_in_line(line)
    return [at_the_end, *([word] for word in at_the_end[0].split()[:_MOST_WORDS])]


def _found(pattern: re.Pattern[bytes], file: Path, most_bytes: int) -> Iterator[bytes]:
    """Yield the first group of the matches, each text once."""
    seen = set[bytes]()
    for text in _matches(pattern, file, most_bytes):
        if text not in seen:
            seen.add(text)
            yield text
        if len(seen) == _MOST_REFERENCES:
            return


def _matches(pattern: re.Pattern[bytes], file: Path, most_bytes: int) -> Iterator[bytes]:
    """Yield the first group of each match, in pieces that overlap."""
    rest = b""
    for chunk in _pieces(file, most_bytes):
        text = rest + chunk
        yield from (match[1] for match in pattern.finditer(text))
        rest = text[-_LONGEST:]
    yield from (match[1] for match in pattern.finditer(rest + b"\n"))


def _pieces(file: Path, most_bytes: int) -> Iterator[bytes]:
    with file.open("rb") as plain, gzip.open(plain) as unpacked:
        is_compressed = plain.read(len(GZIP_MAGIC)) == GZIP_MAGIC
        plain.seek(0)
        source = unpacked if is_compressed else plain
        try:
            while most_bytes > 0 and (chunk := source.read(_CHUNK)):
                most_bytes -= len(chunk)
                yield chunk
        except (EOFError, zlib.error, gzip.BadGzipFile):  # the reader of the mesh reports this
            return
