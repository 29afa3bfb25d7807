"""Rays from the faces of a mesh to the other side of the body: the ray caster of Cleave beside Embree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from bench.kernels.timing import cpu_s
from segcore.affinity.frames import tangent_frames
from segcore.affinity.rays import RayCaster
from segcore.clean.surface import Surface, build_surface
from segcore.mesh import Mesh
from segcore.shapes import subdivide

if TYPE_CHECKING:
    from segcore.arrays import FloatArray

RAYS = 48_000  # as in a segmentation: 24 from each of 2,000 patches
HALF_ANGLE = np.deg2rad(60.0)
START = 1e-4  # how far below the surface rays start, in sqrt(total area)
CLOSE = 1e-3  # relative difference of two distances that are the same

Cast: TypeAlias = Callable[[], "FloatArray"]


@dataclass(frozen=True, slots=True)
class Rays:
    """Origins and unit directions, (N, 3) each."""

    origins: FloatArray
    directions: FloatArray


@dataclass(frozen=True, slots=True)
class RayTimes:
    """The cost of a method for one mesh."""

    build_s: float  # to arrange the faces
    cast_s: float
    same: float  # share of the rays for which the distance is that of Cleave


def embree_is_installed() -> bool:
    return find_spec("embreex") is not None


def rays_inward(surface: Surface, count: int) -> Rays:
    """Random rays from all over a surface into cones around the inward normals."""
    rng = np.random.default_rng(0)
    face = rng.choice(len(surface.faces), count, p=surface.areas / surface.areas.sum())
    inward = -surface.normals[face]
    weights = rng.dirichlet(np.ones(3), count)
    size = float(np.sqrt(surface.areas.sum()))
    origins = np.einsum("ij,ijk->ik", weights, surface.vertices[surface.faces[face]]) + START * size * inward
    sine, turn = np.sin(HALF_ANGLE) * np.sqrt(rng.random(count)), 2 * np.pi * rng.random(count)
    u, v = tangent_frames(inward)
    across = (sine * np.cos(turn))[:, None] * u + (sine * np.sin(turn))[:, None] * v
    return Rays(origins, across + np.sqrt(1 - sine**2)[:, None] * inward)


def cleave(surface: Surface, rays: Rays) -> Cast:
    caster = RayCaster.of(surface.vertices, surface.faces)
    return partial(caster.inner_distances, rays.origins, rays.directions)


def embree(surface: Surface, rays: Rays) -> Cast:
    """Embree by its Python binding embreex; a face met from its front counts as none, as for Cleave."""
    scene = import_module("embreex.rtcore_scene").EmbreeScene()
    import_module("embreex.mesh_construction").TriangleMesh(
        scene, surface.vertices.astype(np.float32), surface.faces.astype(np.int32)
    )
    origins, directions = rays.origins.astype(np.float32), rays.directions.astype(np.float32)

    def cast() -> FloatArray:
        hit = scene.run(origins, directions, output=True)
        from_inside = np.einsum("ij,ij->i", hit["Ng"], directions) > 0
        return np.where((hit["primID"] >= 0) & from_inside, hit["tfar"], np.inf)

    cast()  # Embree arranges the faces at the first ray
    return cast


def subdivided(mesh: Mesh, faces: int) -> Mesh:
    """Split all faces in four until there are enough."""
    vertices, triangles = mesh.vertices, mesh.faces
    while len(triangles) < faces:
        vertices, triangles = subdivide(vertices, triangles)
    return Mesh(vertices, triangles)


def measure(mesh: Mesh, runs: int) -> dict[str, RayTimes]:
    """Return the times of every method that is installed."""
    surface = build_surface(mesh)
    rays = rays_inward(surface, RAYS)
    methods = {"Cleave": cleave, "Embree": embree} if embree_is_installed() else {"Cleave": cleave}
    expected = cleave(surface, rays)()
    return {name: _measured(partial(make, surface, rays), expected, runs) for name, make in methods.items()}


def _measured(make: Callable[[], Cast], expected: FloatArray, runs: int) -> RayTimes:
    cast = make()
    found = cast()
    build_s, cast_s = cpu_s(make, runs), cpu_s(cast, runs)
    same = np.isclose(found, expected, rtol=CLOSE, atol=CLOSE * np.sqrt(CLOSE))
    return RayTimes(build_s, cast_s, float(same.mean()))
