"""The USD writers: one mesh with its parts, at every level, as subsets of its faces."""

import os
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, BinaryIO

from segcore.hierarchy import Hierarchy
from segcore.io.names import SegmentNames, identifiers, segment_names
from segcore.io.palette import SegmentColors, linear_rgb, segment_colors
from segcore.io.slices import group
from segcore.io.usd.families import level_families
from segcore.io.usd.library import library
from segcore.io.usd.polygons import corner_loops
from segcore.io.usd.scene import add_family, add_labels, bind_materials, define_mesh, define_stage
from segcore.mesh import Mesh

_LAYER, _PACKAGE = "model.usdc", "model.usdz"
_DATE = 10 * 365.25 * 86_400  # of the member of a package, so that the same input gives the same bytes: in 1980


def write_usdc(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
) -> None:
    """Write binary USD: the mesh ``/Model/Mesh`` with families of GeomSubset prims.

    The faces are the polygons of the input in their order; polygons that the hierarchy divides are triangles. The parts
    of this level are the family ``materialBind``, called by their names as valid identifiers, with the names as they
    are for display. Each has a material with its colour, and ``primvars:part`` has the label of every face. The parts
    ``parts_k`` of the automatic level are the family ``parts``, and those of the other levels K that are offered,
    ``level_K_k``, the family ``level_K``: see :func:`segcore.io.usd.families.level_families`. Every family is a
    partition of the faces.

    ``metersPerUnit`` and ``upAxis`` are those of the mesh. If its unit is not known it is taken as metres, and the axis
    as the one that programs show upwards for its format. Normals and texture coordinates of the input are written, its
    colours are not. Coordinates that float32 would round visibly are relative to the centre, and the mesh is moved
    there.

    Parameters
    ----------
    target : a binary file; needs ``write`` only.
    segments : the number of segments K, by default the automatic one.
    names : names of segments by label, in place of ``segment k``.
    part_colors : colours of segments by label, in place of the fixed ones.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    MissingPackage
        If usd-core is not installed.

    References
    ----------
    https://openusd.org/release/api/class_usd_geom_subset.html
    """
    labels, usd = hierarchy.labels(segments), library()
    count = len(hierarchy.segment_nodes(segments))
    loops = corner_loops(mesh.faces, mesh.source_polygon, hierarchy.face_leaf)
    families = {
        family: (hierarchy.labels(number)[loops.first_face], number) for family, number in level_families(hierarchy)
    }
    levels = {family: [f"{family}_{k}" for k in range(number)] for family, (_, number) in families.items()}
    titles = segment_names(names, count)
    prims = identifiers(titles, {prim for level in levels.values() for prim in level})

    def write(path: Path) -> None:
        stage = usd.Usd.Stage.CreateNew(str(path))
        define_stage(usd, stage, mesh.coordinates)
        geometry = define_mesh(usd, stage, mesh, loops)
        own = labels[loops.first_face]
        add_labels(usd, geometry, own)
        subsets = add_family(usd, geometry, usd.UsdShade.Tokens.materialBind, group(own, count), prims, titles)
        bind_materials(usd, stage, subsets, linear_rgb(segment_colors(count, part_colors)))
        for family, (of_level, number) in families.items():
            add_family(usd, geometry, family, group(of_level, number), levels[family], segment_names(None, number))
        stage.GetRootLayer().Save()

    _copy(target, _LAYER, write)


def write_usdz(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    **options: Any,
) -> None:
    """Write a USDZ package with the file that :func:`write_usdc` writes, which has the same parameters."""
    usd = library()

    def write(path: Path) -> None:
        layer = path.with_name(_LAYER)
        with layer.open("wb") as file:
            write_usdc(file, mesh, hierarchy, segments, **options)
        os.utime(layer, (_DATE, _DATE))
        package = usd.Sdf.ZipFileWriter.CreateNew(str(path))
        package.AddFile(str(layer), _LAYER)
        package.Save()

    _copy(target, _PACKAGE, write)


def _copy(target: BinaryIO, name: str, write: Callable[[Path], None]) -> None:
    """Copy a file to the target that a function writes in a temporary folder, as usd-core writes to paths only."""
    with TemporaryDirectory(prefix="cleave-") as folder:
        path = Path(folder) / name
        write(path)
        target.write(path.read_bytes())
