"""Corrections of a segmentation by hand: the public class."""

from collections.abc import Iterable

import numpy as np

from segcore.arrays import BoolArray, IntArray
from segcore.clean.surface import Surface, build_surface
from segcore.edit.borders import border_along, divided, least_border, smoothed
from segcore.edit.corrections import Mark
from segcore.edit.distances import marked_components
from segcore.edit.guide_graph import face_guide_graph, guide_clusters
from segcore.edit.local_cut import minimum_cut
from segcore.edit.marked_part import MarkedParts
from segcore.edit.tree_parts import TreeParts
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh

# Above this number of faces the parts are found among clusters of faces, and their borders then drawn on the faces.
# Set by hand.
_MOST_NODES = 24_000


class Guide:
    """The weights of one mesh, and the parts of its hierarchy, for corrections by hand.

    The weights are those of the default parameters, whatever the parameters of the hierarchy. Faces are given by their
    numbers in the mesh. Results depend on the arguments alone. Making a guide costs about as much as the first stages
    of :func:`segcore.segment`; it holds about 300 bytes for each face. A guide is not to be used by several threads at
    once.

    Parameters
    ----------
    mesh : any mesh.
    hierarchy : the result of :func:`segcore.segment` for this mesh.
    surface : ``build_surface(mesh)``, if the caller has computed it already.

    Raises
    ------
    InvalidParameters
        If the hierarchy is not one of this mesh.
    """

    def __init__(
        self,
        mesh: Mesh,
        hierarchy: Hierarchy,
        surface: Surface | None = None,
    ) -> None:
        if len(hierarchy.face_leaf) != len(mesh.faces):
            raise InvalidParameters(
                f"The hierarchy is one of a mesh of {len(hierarchy.face_leaf)} faces; this mesh has {len(mesh.faces)}."
            )
        surface = surface or build_surface(mesh)
        self._face_of_input = surface.face_of_input
        self._normals = surface.normals
        self._faces = face_guide_graph(surface)
        leaf = np.empty(self._faces.count, dtype=np.int32)
        leaf[self._face_of_input] = hierarchy.face_leaf
        clusters = guide_clusters(self._faces, leaf, _MOST_NODES)
        self._cluster = clusters.of_face
        self._nodes = clusters.graph
        self._marked = MarkedParts(TreeParts.of(hierarchy, clusters.graph, clusters.leaf))

    @property
    def face_count(self) -> int:
        """The number F of faces of the mesh."""
        return len(self._face_of_input)

    def part(self, inside: Iterable[int], outside: Iterable[int] = ()) -> BoolArray:
        """The part that a person means who marks some faces.

        One mark selects the part of the hierarchy that people most probably mean. Each further mark that is on the
        wrong side adds or takes away the part of the hierarchy, or the region behind the nearest good border, of which
        it most probably marks the middle. Borders are exact minimum cuts of the weights of the method.

        Parameters
        ----------
        inside : faces of the part, at least one; those under a stroke, or one for each click, in their order.
        outside : faces that do not belong to it, in their order.

        Returns
        -------
        (F,) True for the faces of the part. All marks are obeyed. The part is connected if the marked faces inside are
        connected by it; otherwise each of its components has one of them.

        Raises
        ------
        InvalidParameters
            If no face is marked inside, a face does not exist, or a face is marked on both sides.
        """
        wanted, unwanted = self._checked(inside), self._checked(outside)
        if len(wanted) == 0:
            raise InvalidParameters("Mark at least one face inside the part.")
        both = np.intersect1d(wanted, unwanted)
        if len(both):
            raise InvalidParameters(f"Face {both[0]} is marked both inside and outside the part. Mark it on one side.")
        faces = self._drawn(self._face_of_input[wanted], self._face_of_input[unwanted])
        result: BoolArray = faces[self._face_of_input]
        result[wanted] = True
        result[unwanted] = False
        return result

    def border(self, labels: IntArray, a: int, b: int, stroke: Iterable[int] = ()) -> IntArray:
        """The border between two parts drawn anew.

        Parameters
        ----------
        labels : (F,) the part of every face, 0, 1, ..., of any origin.
        a, b : two parts that touch.
        stroke : faces in the order in which they were drawn; the border is moved to them. Without a stroke the border
            becomes the minimum cut within 0.06 sqrt(total area).

        Returns
        -------
        (F,) labels; other parts do not change.

        Raises
        ------
        InvalidParameters
            If the parts are equal, do not exist or do not touch, or the stroke has no face of either.
        """
        drawn = self._checked(stroke)
        own = self._labels_of_surface(labels)
        self._require_parts(labels, a, b)
        ends = np.sort(own[self._faces.edges], axis=1)
        if a == b or not (ends == np.sort([a, b])).all(axis=1).any():
            raise InvalidParameters(f"The parts {a} and {b} have no common border. Choose two parts that touch.")
        if len(drawn) == 0:
            return self._carried_over(labels, own, least_border(self._faces, own, a, b))
        return self._carried_over(labels, own, border_along(self._faces, own, a, b, self._face_of_input[drawn]))

    def smooth(self, labels: IntArray, parts: Iterable[int] | None = None) -> IntArray:
        """Make jagged borders short.

        Parameters
        ----------
        labels : (F,) the part of every face, 0, 1, ..., of any origin.
        parts : the borders between these parts; by default all.

        Returns
        -------
        (F,) labels. A part keeps at least half of its faces and falls into no more components than before.

        Raises
        ------
        InvalidParameters
            If a part does not exist.
        """
        own = self._labels_of_surface(labels)
        chosen = sorted(set(own.tolist() if parts is None else map(int, parts)))
        self._require_parts(labels, *chosen)
        return self._carried_over(labels, own, smoothed(self._faces, own, chosen))

    def cut(self, labels: IntArray, part: int, stroke: Iterable[int]) -> IntArray:
        """Divide a part along a stroke.

        Parameters
        ----------
        labels : (F,) the part of every face, 0, 1, ..., of any origin.
        part : the part that is divided.
        stroke : faces in the order in which they were drawn, at least two of the part. Beyond its ends the border takes
            the cheapest way around the part.

        Returns
        -------
        (F,) labels; the smaller side of the part has the next new label.

        Raises
        ------
        InvalidParameters
            If the part does not exist or the stroke does not divide it.
        """
        drawn = self._checked(stroke)
        own = self._labels_of_surface(labels)
        self._require_parts(labels, part)
        new = divided(self._faces, self._normals, own, part, self._face_of_input[drawn])
        return self._carried_over(labels, own, new)

    def _labels_of_surface(self, labels: IntArray) -> IntArray:
        """(F,) labels of the faces of the surface."""
        if np.shape(labels) != (self.face_count,):
            raise InvalidParameters(
                f"Give a label for each of the {self.face_count} faces, not an array of shape {np.shape(labels)}."
            )
        own = np.empty(self._faces.count, dtype=np.int32)
        own[self._face_of_input[::-1]] = np.asarray(labels)[::-1]  # the first of faces that one face represents
        return own

    def _carried_over(self, labels: IntArray, before: IntArray, after: IntArray) -> IntArray:
        """(F,) labels of the mesh, changed with those of the surface."""
        changed = (before != after)[self._face_of_input]
        result: IntArray = np.where(changed, after[self._face_of_input], labels).astype(np.int32)
        return result

    @staticmethod
    def _require_parts(labels: IntArray, *parts: int) -> None:
        missing = np.setdiff1d(parts, labels)
        if len(missing):
            raise InvalidParameters(f"There is no part {missing[0]}.")

    def _drawn(self, wanted: IntArray, unwanted: IntArray) -> BoolArray:
        """(F,) the part, over the faces of the surface."""
        marks = dict.fromkeys(Mark(int(node), True) for node in self._cluster[wanted])
        taken = {mark.node for mark in marks}
        marks |= dict.fromkeys(Mark(int(node), False) for node in self._cluster[unwanted] if int(node) not in taken)
        inside = self._marked.of(list(marks))
        if self._nodes is self._faces:
            return inside
        return self._redrawn(inside, wanted, unwanted)

    def _redrawn(self, clusters: BoolArray, wanted: IntArray, unwanted: IntArray) -> BoolArray:
        """(F,) a part of clusters, its border drawn anew on the faces of the clusters on both sides of it."""
        ends = self._nodes.edges[clusters[self._nodes.edges[:, 0]] != clusters[self._nodes.edges[:, 1]]]
        at_border = np.zeros(self._nodes.count, dtype=bool)
        at_border[ends] = True
        faces, free = clusters[self._cluster], at_border[self._cluster]
        faces[wanted], faces[unwanted] = True, False
        free[wanted] = free[unwanted] = False
        drawn = minimum_cut(self._faces.rows, self._faces.cost, faces, free)
        connected: BoolArray = marked_components(self._faces.rows, drawn, wanted)
        return connected

    def _checked(self, faces: Iterable[int]) -> IntArray:
        numbers = np.asarray(list(faces), dtype=np.int64)
        wrong = numbers[(numbers < 0) | (numbers >= self.face_count)]
        if len(wrong):
            raise InvalidParameters(f"There is no face {wrong[0]}: the mesh has the faces 0 to {self.face_count - 1}.")
        return numbers.astype(np.int32)
