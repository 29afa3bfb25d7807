"""Models of the operations in the body of an edit, and the operations of segcore that they mean."""

from typing import Annotated, Literal, TypeAlias, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from segcore.arrays import IntArray
from segcore.edit.operations import (
    Assign,
    Border,
    Cut,
    Describe,
    FindPart,
    Merge,
    Operation,
    Restore,
    Smooth,
)
from segcore.errors import InvalidParameters
from segcore.levels import Fineness, Level

_MOST_FACES = 10_000_000  # of a set of faces; more than any installation segments
_Number = Annotated[int, Field(ge=0, lt=2**31)]
_PartNumber = Annotated[int, Field(ge=0, lt=2**31, description="The number of a part.")]
_Text = Annotated[str, Field(min_length=1, max_length=200, pattern=r"^[^\x00-\x1f\x7f]*$")]


Model = TypeVar("Model", bound=BaseModel)


class _Document(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class FaceRuns(_Document):
    """Faces as runs: lengths[i] faces from starts[i] on, for each i."""

    starts: list[_Number] = Field(max_length=_MOST_FACES)
    lengths: list[Annotated[int, Field(ge=1, lt=2**31)]] = Field(max_length=_MOST_FACES)


Faces: TypeAlias = Annotated[
    Annotated[list[_Number], Field(max_length=_MOST_FACES)] | FaceRuns,
    Field(description="Faces of the file, as a list or as runs."),
]


class LevelDocument(_Document):
    """A level of the automatic result, as in the query of the results; by default the automatic one."""

    segments: int | None = Field(default=None, ge=1)
    granularity: float | None = Field(default=None, ge=0, le=1)
    splits: list[_Number] | None = Field(default=None, max_length=10_000)

    def level(self) -> Level:
        """Return the level.

        Raises
        ------
        InvalidParameters
            If several of the fields are given.
        """
        return Level(Fineness(self.segments, self.granularity), None if self.splits is None else tuple(self.splits))


class MergeDocument(_Document):
    """Several parts become one, which has the number and the colour of the first."""

    op: Literal["merge"]
    parts: list[_PartNumber] = Field(min_length=2, max_length=10_000)

    def operation(self) -> Operation:
        return Merge(tuple(self.parts))


class AssignDocument(_Document):
    """Faces are moved to a part."""

    op: Literal["assign"]
    faces: Faces
    to: _PartNumber | Literal["new"]

    def operation(self) -> Operation:
        return Assign(_array(self.faces), self.to)


class FindPartDocument(_Document):
    """The part that is meant by marked faces becomes a part of its own, or is added to one."""

    op: Literal["part"]
    inside: Faces
    outside: Faces = []
    to: _PartNumber | Literal["new"] = "new"

    def operation(self) -> Operation:
        return FindPart(_array(self.inside), _array(self.outside), self.to)


class CutDocument(_Document):
    """A part is divided along a stroke; one side becomes a new part."""

    op: Literal["cut"]
    part: _PartNumber
    stroke: Faces

    def operation(self) -> Operation:
        return Cut(self.part, _array(self.stroke))


class BorderDocument(_Document):
    """The border between two parts follows a stroke, or without one becomes the least cut near it."""

    op: Literal["border"]
    a: _PartNumber
    b: _PartNumber
    stroke: Faces = []

    def operation(self) -> Operation:
        return Border(self.a, self.b, _array(self.stroke))


class SmoothDocument(_Document):
    """The borders of some parts, or of all that are not locked, become short."""

    op: Literal["smooth"]
    parts: list[_PartNumber] | None = Field(default=None, min_length=1, max_length=10_000)

    def operation(self) -> Operation:
        return Smooth(None if self.parts is None else tuple(self.parts))


class NameDocument(_Document):
    op: Literal["name"]
    part: _PartNumber
    name: _Text = Field(examples=["left arm"])

    def operation(self) -> Operation:
        return Describe(self.part, name=_said(self.name))


class DeleteNameDocument(_Document):
    op: Literal["delete_name"]
    part: _PartNumber

    def operation(self) -> Operation:
        return Describe(self.part, name="")


class ColorDocument(_Document):
    op: Literal["color"]
    part: _PartNumber
    color: Annotated[str, Field(pattern=r"^#[0-9a-fA-F]{6}$")] | None = Field(
        description="Null for the colour of its number.", examples=["#56b4e9"]
    )

    def operation(self) -> Operation:
        return Describe(self.part, color=(self.color or "").lower())


class ClassDocument(_Document):
    """A part gets a class, by which labels of many meshes are collected."""

    op: Literal["class"]
    part: _PartNumber
    class_name: _Text | None = Field(alias="class", description="Null for none.", examples=["limb"])

    def operation(self) -> Operation:
        return Describe(self.part, class_name="" if self.class_name is None else _said(self.class_name))


class LockDocument(_Document):
    """The faces of a part stay in it until it is unlocked."""

    op: Literal["lock", "unlock"]
    part: _PartNumber

    def operation(self) -> Operation:
        return Describe(self.part, locked=self.op == "lock")


class RestoreDocument(_Document):
    """The parts become what they were in an earlier revision; 0 is the automatic result."""

    op: Literal["restore"]
    revision: Annotated[int, Field(ge=0, lt=2**31)]
    level: LevelDocument | None = Field(default=None, description="Of the automatic result, with revision 0.")

    def operation(self) -> Operation:
        if self.level is not None and self.revision:
            raise InvalidParameters("A level belongs to revision 0: leave it out, or restore revision 0.")
        return Restore(self.revision, Level() if self.level is None else self.level.level())


AnyOperation = Annotated[
    MergeDocument
    | AssignDocument
    | FindPartDocument
    | CutDocument
    | BorderDocument
    | SmoothDocument
    | NameDocument
    | DeleteNameDocument
    | ColorDocument
    | ClassDocument
    | LockDocument
    | RestoreDocument,
    Field(discriminator="op"),
]


class OperationsDocument(_Document):
    """Operations on parts; each refers to the parts after the one before it."""

    level: LevelDocument | None = Field(
        default=None, description="With base 0, the level of the automatic result that is edited."
    )
    operations: list[AnyOperation] = Field(min_length=1, max_length=1000)

    def all(self) -> list[Operation]:
        """Return the operations.

        Raises
        ------
        InvalidParameters
            If one contradicts itself.
        """
        return [one.operation() for one in self.operations]

    def level_of_base(self, base: int) -> Level:
        """Return the level of the automatic result that is edited.

        Raises
        ------
        InvalidParameters
            If a level is given although the base is no automatic result.
        """
        if self.level is not None and base:
            raise InvalidParameters("A level belongs to base 0: leave it out, or restore revision 0 at that level.")
        return Level() if self.level is None else self.level.level()


class LocalEditDocument(OperationsDocument):
    """An edit of the parts in a file."""

    base: int | None = Field(default=None, ge=0, lt=2**31, description="The revision in the file, to be checked.")


class EditDocument(OperationsDocument):
    """An edit of the newest revision."""

    base: int = Field(ge=0, lt=2**31, description="The newest revision, which is edited; 0 if there is none yet.")

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "base": 0,
                "level": {"segments": 8},
                "operations": [{"op": "merge", "parts": [1, 4]}, {"op": "name", "part": 1, "name": "trunk"}],
            }
        }
    )


def _said(text: str) -> str:
    """Return a text without white space around it.

    Raises
    ------
    InvalidParameters
        If nothing is left.
    """
    if not text.strip():
        raise InvalidParameters("A name is not blank: use delete_name, or the class null, to remove one.")
    return text.strip()


def _array(faces: list[int] | FaceRuns) -> IntArray:
    """(N,) faces.

    Raises
    ------
    InvalidParameters
        If runs have not as many lengths as starts, or are longer than any mesh.
    """
    if not isinstance(faces, FaceRuns):
        return np.array(faces, dtype=np.int32)
    starts, lengths = np.array(faces.starts, dtype=np.int64), np.array(faces.lengths, dtype=np.int64)
    if len(starts) != len(lengths) or lengths.sum() > _MOST_FACES:
        raise InvalidParameters("Runs of faces need a length for each start, and no face twice.")
    offsets = np.repeat(np.cumsum(lengths) - lengths, lengths)
    every = np.repeat(starts, lengths) + np.arange(int(lengths.sum())) - offsets
    if len(every) and every.max() >= 2**31:
        raise InvalidParameters(f"There is no face {int(every.max())}.")
    return every.astype(np.int32)


def parsed_as(model: type[Model], text: bytes | bytearray) -> Model:
    """Return a document from JSON.

    Raises
    ------
    InvalidParameters
        If it is no such document; the message names the first wrong value.
    """
    try:
        return model.model_validate_json(bytes(text))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(str(step) for step in first["loc"])
        raise InvalidParameters(f"{place or 'The document'} is not valid: {first['msg']}.") from None
