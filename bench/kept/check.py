"""Compares a file with the output that keeps everything of it."""

from __future__ import annotations

import hashlib
import io
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from bench.kept.three_page import ThreePage
    from segcore.arrays import FloatArray
    from segcore.hierarchy import Hierarchy
    from segcore.mesh import Mesh

_BANDS = 5  # parts, across the longest side, so that most primitives are divided
TIMES = (0.0, 0.4)  # seconds of the animations at which files are compared; set by hand


@dataclass(frozen=True, slots=True)
class Comparison:
    """What differs between a file and its output."""

    file: str
    faces: int
    parts: int
    bytes_before: int  # of the model file alone
    bytes_after: int
    pictures: int  # that are embedded
    lost_pictures: int  # whose bytes the output does not have, although the set has them
    new_errors: list[str]  # codes of the validator that the input does not cause
    differing_pixels: int  # the most at one of TIMES
    drawn_pixels: int
    largest_move: float  # of a corner at one of TIMES, in sizes of the model; infinite if triangles are missing
    notes: int  # on what could not be kept


def compare(path: Path, page: ThreePage | None, validator: Path | None) -> Comparison:
    """Write a file with everything kept and compare both.

    Raises
    ------
    CleaveError
        If the file cannot be read.
    BenchmarkError
        If three.js cannot read one of the two.
    """
    from segcore.io import Original, read_mesh, write_kept

    mesh = read_mesh(path, neighbours=True)
    target = io.BytesIO()
    notes = write_kept(target, Original(path, neighbours=True), bands(mesh), mesh=mesh)
    output = target.getvalue()
    before, after = pictures_of(path.read_bytes(), path), pictures_of(output, None)
    differing, drawn, move = (0, 0, 0.0) if page is None else _seen(page, path, output)
    return Comparison(
        file=path.name,
        faces=len(mesh.faces),
        parts=min(_BANDS, len(mesh.faces)),
        bytes_before=path.stat().st_size,
        bytes_after=len(output),
        pictures=len(after),
        lost_pictures=len(set(before) - set(after)),
        new_errors=[] if validator is None else _new_errors(validator, path, output),
        differing_pixels=differing,
        drawn_pixels=drawn,
        largest_move=move,
        notes=len(notes),
    )


def bands(mesh: Mesh) -> Hierarchy:
    """Return a hierarchy of bands with equal numbers of faces across the longest side of a mesh."""
    from segcore.hierarchy import Hierarchy

    centres = mesh.corners.mean(axis=1)
    order = np.argsort(np.argsort(centres[:, np.ptp(centres, axis=0).argmax()], kind="stable"), kind="stable")
    count = min(_BANDS, len(mesh.faces))
    band = order * count // len(mesh.faces)
    splits = np.array([0, *range(1, 2 * count - 3, 2)][: count - 1], dtype=np.int32)
    leaf = np.where(band > 0, 2 * band, max(2 * count - 3, 0)).astype(np.int32)
    nodes = 2 * count - 1
    return Hierarchy(splits, np.zeros(count - 1), np.zeros(nodes), np.zeros(nodes, dtype=np.int32), leaf, count)


def pictures_of(data: bytes, path: Path | None) -> list[str]:
    """Return the SHA-256 of every picture of a glTF file that is inside the file or in its folder."""
    from segcore.io import ReadLimits
    from segcore.io.file_sets import FolderCompanions
    from segcore.io.gltf.document import read_document, view_bytes

    companions = None if path is None else FolderCompanions(path, ReadLimits())
    document = read_document(data, companions)
    found = []
    for index in range(document.count("images")):
        image = document.item("images", index)
        if "bufferView" in image:
            found.append(bytes(view_bytes(document, image["bufferView"])))
        elif (picture := _picture(image, document)) is not None:
            found.append(picture)
    return [hashlib.sha256(picture).hexdigest() for picture in found]


def _picture(image: dict[str, Any], document: Any) -> bytes | None:
    from segcore.io.gltf.kept.pictures import embedded_picture

    picture = embedded_picture(image, document.companions, "image")
    return None if isinstance(picture, str) else picture.data


def _seen(page: ThreePage, path: Path, output: bytes) -> tuple[int, int, float]:
    from playwright.sync_api import Error

    page.models = {"before": path, "after": output}
    differing, drawn, move = 0, 0, 0.0
    try:
        for seconds in TIMES:
            pixels = page.differing_pixels("before", "after", seconds)
            differing, drawn = max(differing, pixels[0]), max(drawn, pixels[1])
            move = max(move, largest_move(page.triangles("before", seconds), page.triangles("after", seconds)))
    except Error as error:
        raise BenchmarkError(f"three.js cannot read {path.name}: {str(error).splitlines()[0][:100]}") from error
    return differing, drawn, move


def largest_move(before: FloatArray, after: FloatArray) -> float:
    """Return the largest distance, in nine coordinates, of a triangle to the nearest one of the other set.

    It is in sizes of the first set.

    The corners of a triangle may begin with any of the three. If the sets differ in number, the result is infinite.

    Parameters
    ----------
    before, after : (F, 3, 3) corners of triangles in any order.
    """
    from scipy.spatial import cKDTree

    if before.shape != after.shape:
        return float("inf")
    size = float(np.ptp(before.reshape(-1, 3), axis=0).max()) or 1.0
    distances = [
        cKDTree(np.concatenate([np.roll(there, turn, axis=1) for turn in range(3)]).reshape(-1, 9)).query(
            here.reshape(-1, 9)
        )[0]
        for here, there in ((before, after), (after, before))
    ]
    return max(float(np.max(distance)) for distance in distances) / size


def _new_errors(validator: Path, path: Path, output: bytes) -> list[str]:
    """The codes of errors that the validator finds in the output and not in the input."""
    before = _errors(validator, path.read_bytes(), path.resolve().parent)
    return sorted(_errors(validator, output, None) - before)


_PROGRAM = """
const [validator, folder] = process.argv.slice(1);
const fs = require("fs");
const beside = async (uri) => new Uint8Array(fs.readFileSync(require("path").join(folder, decodeURIComponent(uri))));
const options = { maxIssues: 0, ...(folder && { externalResourceFunction: beside }) };
require(validator)
  .validateBytes(new Uint8Array(fs.readFileSync(0)), options)
  .then((report) => console.log(JSON.stringify(report.issues.messages)));
"""


def _errors(validator: Path, data: bytes, folder: Path | None) -> set[str]:
    command = ["node", "-e", _PROGRAM, str(validator.resolve()), str(folder or "")]
    done = subprocess.run(command, input=data, capture_output=True, check=False)
    if done.returncode:
        raise BenchmarkError(f"The validator in {validator} does not run: {done.stderr.decode()[-200:]}")
    return {message["code"] for message in json.loads(done.stdout) if message["severity"] == 0}
