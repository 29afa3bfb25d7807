"""Each part of a glTF document as a document of its own."""

from dataclasses import dataclass, field

from segcore.arrays import IntArray
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.document import Document, Item, indices
from segcore.io.gltf.kept.asset import KeptAsset
from segcore.io.gltf.kept.marks import Marks
from segcore.io.gltf.kept.part_data import PartData, new_asset
from segcore.io.gltf.kept.writer import KeptDocument, divide_document
from segcore.io.gltf.scene import INSTANCING, placed_nodes, scene_roots
from segcore.io.limits import ReadLimits

_OF_NODES_LEFT_OUT = ("mesh", "skin", "weights", "camera", "children", "extensions")
_QUANTIZATION = "KHR_mesh_quantization"  # the only extension that is used without an object of its name


@dataclass(slots=True, eq=False)
class SingleParts:
    """The parts of a document, each with its nodes and those above them, and all that its faces need.

    Cameras, lights, variants, and extensions other than those of materials and textures are left out.
    """

    source: Document
    accessors: Accessors
    meshes: dict[int, list[int | None]]  # the parts of the primitives of divided meshes
    notes: tuple[str, ...]  # on what could not be kept
    _nodes: dict[int, list[int]] = field(default_factory=dict)  # of the scene, by part
    _parent: dict[int, int] = field(default_factory=dict)

    @classmethod
    def of(cls, kept: KeptDocument, part_of_face: IntArray, names: list[str], limits: ReadLimits) -> "SingleParts":
        """Divide a document; ``part_of_face`` (F,) is the part of each face of the mesh that was segmented."""
        divided = KeptAsset.of(kept.document)
        meshes = divide_document(divided, kept, part_of_face, Marks(names), limits, is_plain=True)
        buffers = {index: data for index, data in enumerate(divided.buffers) if data is not None}
        source = Document(divided.root, None, kept.document.size, kept.document.companions, buffers)
        return cls(source, Accessors(source, limits), meshes, (*kept.notes, *divided.notes))

    def __post_init__(self) -> None:
        for node in range(self.source.count("nodes")):
            for child in indices(self.source.item("nodes", node), "children", f"nodes[{node}]"):
                self._parent[child] = node
        for node, _ in placed_nodes(self.source, scene_roots(self.source)):
            parts = self.meshes.get(self.source.item("nodes", node).get("mesh", -1), [])
            for part in {part for part in parts if part is not None}:
                self._nodes.setdefault(part, []).append(node)

    def part(self, part: int) -> KeptAsset:
        """Return a part as an asset."""
        shown = self._nodes.get(part, [])
        numbers = {node: i for i, node in enumerate(sorted(self._with_joints_and_parents(shown)))}
        asset = new_asset(self.source)
        builder = _PartBuilder(self.source, PartData(self.source, self.accessors, asset), numbers, set(shown))
        for node in numbers:
            asset.add("nodes", builder.node(node))
            if node in shown:
                mesh = self.source.item("nodes", node)["mesh"]
                own = [i for i, of in enumerate(self.meshes[mesh]) if of == part]
                asset.root["nodes"][-1] |= builder.shown(node, own)
        roots = [numbers[node] for node in numbers if self._parent.get(node) not in numbers]
        asset.root |= {"scene": 0, "scenes": [{"nodes": roots}]}
        builder.add_animations()
        _declare_extensions(asset, self.source)
        return asset

    def _with_joints_and_parents(self, shown: list[int]) -> set[int]:
        needed: set[int] = set()
        waiting = list(shown)
        for skin in {entry["skin"] for node in shown if "skin" in (entry := self.source.item("nodes", node))}:
            entry = self.source.item("skins", skin)
            waiting += entry["joints"] + ([entry["skeleton"]] if "skeleton" in entry else [])
        while waiting:
            node = waiting.pop()
            if node not in needed:
                needed.add(node)
                waiting += [self._parent[node]] if node in self._parent else []
        return needed


@dataclass(slots=True, eq=False)
class _PartBuilder:
    source: Document
    data: PartData
    numbers: dict[int, int]  # the new numbers of the nodes that are left
    shows: set[int]  # the nodes that have a mesh
    _meshes: dict[int, int] = field(default_factory=dict)
    _skins: dict[int, int] = field(default_factory=dict)

    def node(self, node: int) -> Item:
        """Return a node without its mesh."""
        entry = self.source.item("nodes", node)
        new = {key: value for key, value in entry.items() if key not in _OF_NODES_LEFT_OUT}
        children = [self.numbers[child] for child in entry.get("children", []) if child in self.numbers]
        return new | ({"children": children} if children else {})

    def shown(self, node: int, own: list[int]) -> Item:
        """Return the members of a node for its mesh, of which the primitives ``own`` are left."""
        entry = self.source.item("nodes", node)
        new: Item = {"weights": entry["weights"]} if "weights" in entry else {}
        new["mesh"] = self._mesh(entry["mesh"], own)
        if "skin" in entry:
            new["skin"] = self._skin(entry["skin"])
        copies = entry.get("extensions", {}).get(INSTANCING)
        if copies is not None:
            attributes = {name: self.data.accessor(at, is_attribute=True) for name, at in copies["attributes"].items()}
            new["extensions"] = {INSTANCING: {"attributes": attributes}}
        return new

    def add_animations(self) -> None:
        """Add the animations of the nodes that are left."""
        for animation in self.source.root.get("animations", []):
            samplers: dict[int, int] = {}
            channels = []
            for channel in filter(self._is_left, animation.get("channels", [])):
                target = {**channel["target"], "node": self.numbers[channel["target"]["node"]]}
                sampler = samplers.setdefault(channel["sampler"], len(samplers))
                channels.append({**channel, "sampler": sampler, "target": target})
            if channels:
                own = [self._sampler(animation["samplers"][old]) for old in samplers]
                self.data.asset.add("animations", {**animation, "channels": channels, "samplers": own})

    def _is_left(self, channel: Item) -> bool:
        target = channel["target"]
        node = target.get("node")
        return node in self.shows if target.get("path") == "weights" else node in self.numbers

    def _sampler(self, sampler: Item) -> Item:
        times, values = self.data.accessor(sampler["input"]), self.data.accessor(sampler["output"])
        return {**sampler, "input": times, "output": values}

    def _mesh(self, mesh: int, own: list[int]) -> int:
        if mesh not in self._meshes:
            entry = self.source.item("meshes", mesh)
            primitives = [self.data.primitive(entry["primitives"][i]) for i in own]
            kept = {key: value for key, value in entry.items() if key != "extensions"}
            self._meshes[mesh] = self.data.asset.add("meshes", {**kept, "primitives": primitives})
        return self._meshes[mesh]

    def _skin(self, skin: int) -> int:
        if skin not in self._skins:
            entry = dict(self.source.item("skins", skin))
            entry["joints"] = [self.numbers[joint] for joint in entry["joints"]]
            if "skeleton" in entry:
                entry["skeleton"] = self.numbers[entry["skeleton"]]
            if "inverseBindMatrices" in entry:
                entry["inverseBindMatrices"] = self.data.accessor(entry["inverseBindMatrices"])
            self._skins[skin] = self.data.asset.add("skins", entry)
        return self._skins[skin]


def _declare_extensions(asset: KeptAsset, source: Document) -> None:
    used = _extension_names(asset.root)
    if _QUANTIZATION in source.root.get("extensionsUsed", []):
        used.add(_QUANTIZATION)
    required = [name for name in source.root.get("extensionsRequired", []) if name in used]
    asset.root |= {"extensionsUsed": sorted(used)} if used else {}
    asset.root |= {"extensionsRequired": required} if required else {}


def _extension_names(entry: object) -> set[str]:
    if isinstance(entry, list):
        return set().union(*map(_extension_names, entry)) if entry else set()
    if not isinstance(entry, dict):
        return set()
    own = set(entry["extensions"]) if isinstance(entry.get("extensions"), dict) else set()
    return own.union(*(_extension_names(value) for key, value in entry.items() if key != "extras"))
