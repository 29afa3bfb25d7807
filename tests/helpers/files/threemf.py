"""3MF packages composed by hand or by Hypothesis."""

import io
import zipfile
from dataclasses import dataclass, field

from hypothesis import strategies as st

from helpers.files.polygon_soups import Soup, triangle_soups

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
RELATIONSHIPS = (
    '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Type="http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail" '
    'Target="/Metadata/thumbnail.png" Id="rel1"/>'
    '<Relationship Target="{target}" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
TYPES = '<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"/>'


@dataclass
class Model3MF:
    """A model that is being composed."""

    unit: str | None = None
    attributes: str = ""
    objects: list[str] = field(default_factory=list)
    items: list[str] = field(default_factory=list)

    def mesh(self, soup: Soup, name: str = "") -> int:
        vertices = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in soup.vertices)
        triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in soup.triangles)
        return self.add(f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>", name)

    def assembly(self, parts: list[tuple[int, list[float] | None]]) -> int:
        places = "".join(f'<component objectid="{part}"{placed(at)}/>' for part, at in parts)
        return self.add(f"<components>{places}</components>")

    def add(self, content: str, name: str = "") -> int:
        number = len(self.objects) + 1
        named = f' name="{name}"' if name else ""
        self.objects.append(f'<object id="{number}" type="model"{named}>{content}</object>')
        return number

    def item(self, number: int, transform: list[float] | None = None, more: str = "") -> None:
        self.items.append(f'<item objectid="{number}"{placed(transform)} {more}/>')

    def xml(self) -> str:
        unit = f' unit="{self.unit}"' if self.unit else ""
        return (
            f'<?xml version="1.0" encoding="UTF-8"?><model{unit} xmlns="{CORE}" xmlns:p="{PRODUCTION}" '
            f"{self.attributes}><metadata name=\"Title\">vertex x='1'</metadata>"
            f"<resources>{''.join(self.objects)}</resources><build>{''.join(self.items)}</build></model>"
        )

    def package(self, name: str = "3D/3dmodel.model", **more: str | bytes) -> bytes:
        relationships = RELATIONSHIPS.format(target=f"/{name}")
        return package({"[Content_Types].xml": TYPES, "_rels/.rels": relationships, name: self.xml(), **more})


def placed(transform: list[float] | None) -> str:
    return "" if transform is None else f' transform="{" ".join(map(repr, transform))}"'


def package(parts: dict[str, str | bytes], compression: int = zipfile.ZIP_DEFLATED) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", compression) as archive:
        for name, content in parts.items():
            archive.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), content, compression)
    return target.getvalue()


factors = st.sampled_from([1.0, -1.0, 0.5, 2.0, -2.0])
offsets = st.integers(-8, 8).map(float)


@st.composite
def transforms(draw: st.DrawFn) -> list[float] | None:
    """None or 12 numbers, whose products are exact."""
    if draw(st.booleans()):
        return None
    order = draw(st.permutations([0, 1, 2]))
    rows = [[draw(factors) if column == order[row] else 0.0 for column in range(3)] for row in range(3)]
    return [*rows[0], *rows[1], *rows[2], draw(offsets), draw(offsets), draw(offsets)]


@st.composite
def packages(draw: st.DrawFn) -> bytes:
    model = Model3MF(draw(st.sampled_from([None, "millimeter", "micron", "centimeter", "inch", "foot", "meter"])))
    meshes = [model.mesh(draw(triangle_soups())) for _ in range(draw(st.integers(1, 3)))]
    objects = list(meshes)
    for _ in range(draw(st.integers(0, 3))):
        parts = draw(st.lists(st.tuples(st.sampled_from(objects), transforms()), max_size=3))
        objects.append(model.assembly(parts))
    model.item(draw(st.sampled_from(meshes)), draw(transforms()))
    for number in draw(st.lists(st.sampled_from(objects), max_size=3)):
        model.item(number, draw(transforms()))
    return model.package()
