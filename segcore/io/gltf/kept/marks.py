"""What a kept file says of its parts: extras of primitives, and a material variant for every level."""

from dataclasses import dataclass, field
from typing import Any

from segcore.arrays import IntArray
from segcore.io.gltf.document import Item
from segcore.io.gltf.kept.asset import KeptAsset
from segcore.io.gltf.writer_scene import VARIANTS, mappings, segment_materials
from segcore.io.palette import SegmentColors

ORIGINAL_LOOK = "original look"


def with_extras(entry: Item, facts: dict[str, Any]) -> Item:
    """Return a copy of an entry with facts in its extras; if that would replace any, ``original`` has the old ones."""
    extras = entry.get("extras", {})
    if not isinstance(extras, dict) or any(key in extras and extras[key] != facts[key] for key in facts):
        facts = {"original": extras} | facts
    return {**entry, "extras": (extras if isinstance(extras, dict) else {}) | facts}


@dataclass(frozen=True, slots=True, eq=False)
class Marks:
    """The names of the parts and, by part, the materials of the variants."""

    names: list[str]
    mappings: list[list[Item]] = field(default_factory=list)  # by part; empty if there are no variants
    original: int | None = None  # the variant of the original look

    def marked(self, primitive: Item, part: int) -> Item:
        """Return a copy of a primitive that says which part it is."""
        entry = with_extras(primitive, {"part": part, "name": self.names[part]})
        if self.original is None:
            return entry
        extensions = dict(entry.get("extensions", {}))
        known = extensions.get(VARIANTS, {})
        own = [{"material": entry["material"], "variants": [self.original]}] if "material" in entry else []
        extensions[VARIANTS] = {**known, "mappings": [*known.get("mappings", []), *own, *self.mappings[part]]}
        return {**entry, "extensions": extensions}


def add_variants(
    asset: KeptAsset,
    names: list[str],
    materials: IntArray,
    variants: list[str],
    part_colors: SegmentColors | None = None,
) -> Marks:
    """Add the materials of the parts and the variants: the original look, then one for each level.

    Parameters
    ----------
    names : (D,) names of the parts.
    materials : (L, D) the label whose colour each part has at each level.
    variants : (L,) names of the levels.
    part_colors : colours of parts by label, in place of the fixed ones.
    """
    first_material = len(asset.entries("materials"))
    asset.entries("materials").extend(segment_materials(names, part_colors))
    asset.use_extension(VARIANTS)
    table = asset.root.setdefault("extensions", {}).setdefault(VARIANTS, {}).setdefault("variants", [])
    original = len(table)
    taken = [entry.get("name") for entry in table]
    table += [{"name": _unused(name, taken)} for name in (ORIGINAL_LOOK, *variants)]
    of_parts = [
        [
            {
                "material": first_material + mapping["material"],
                "variants": [original + 1 + level for level in mapping["variants"]],
            }
            for mapping in mappings(materials[:, part])
        ]
        for part in range(len(names))
    ]
    return Marks(names, of_parts, original)


def _unused(name: str, taken: list[object]) -> str:
    number, unused = 1, name
    while unused in taken:
        number += 1
        unused = f"{name} ({number})"
    return unused
