"""3MF projects of slicers, with settings beside the model."""

from helpers.files.polygon_soups import Soup
from helpers.files.samples import SQUARE
from helpers.files.threemf import Model3MF

PRUSA, BAMBU = "Metadata/Slic3r_PE_model.config", "Metadata/model_settings.config"
HEAD = '<?xml version="1.0" encoding="UTF-8"?>'
TWO_SQUARES = Soup(
    [*SQUARE.vertices, *((x + 5, y, z) for x, y, z in SQUARE.vertices)],
    [*SQUARE.polygons, *(tuple(i + 4 for i in face) for face in SQUARE.polygons)],
)


def prusa(first: object, last: object, *metadata: tuple[str, str], number: int = 1) -> str:
    """Settings with one body, triangles 0 and 1, and one more volume."""
    values = "".join(f'<metadata type="volume" key="{key}" value="{value}"/>' for key, value in metadata)
    body = '<volume firstid="0" lastid="1"><metadata type="volume" key="volume_type" value="ModelPart"/></volume>'
    volume = f'<volume firstid="{first}" lastid="{last}">{values}</volume>'
    return f'{HEAD}<config><object id="{number}">{body}{volume}</object></config>'


def prusa_project(settings: str | bytes, name: str = PRUSA) -> bytes:
    model = Model3MF()
    model.mesh(TWO_SQUARES)
    model.item(1)
    return model.package(**{name: settings})


def bambu_project(subtypes: list[str], settings: str | None = None) -> bytes:
    """An object with a component for each subtype, in another part of the package."""
    other = Model3MF()
    for k in range(len(subtypes)):
        other.mesh(SQUARE, f"mesh {k + 1}")
    components = "".join(
        f'<component p:path="/3D/Objects/object_1.model" objectid="{k + 1}" transform="1 0 0 0 1 0 0 0 1 {k} 0 0"/>'
        for k in range(len(subtypes))
    )
    parts = "".join(
        f'<part id="{k + 1}" subtype="{kind}"><metadata key="name" value="part {k + 1}"/></part>'
        for k, kind in enumerate(subtypes)
    )
    model = Model3MF(attributes='requiredextensions="p"')
    model.objects.append(f'<object id="9" type="model"><components>{components}</components></object>')
    model.item(9)
    own = settings or f'{HEAD}<config><object id="9"><metadata key="name" value="all"/>{parts}</object></config>'
    return model.package(**{"3D/Objects/object_1.model": other.xml(), BAMBU: own})
