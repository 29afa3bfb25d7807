"""A streaming parser for multipart/form-data: meshes are written to uploads, parameters are kept in memory."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NoReturn

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header

from service.problems import Problem
from service.submit.disposition import file_name_in
from worker.jobs.store.upload import MeshUpload

MAX_PARAMETERS_BYTES = 16 * 1024
MAX_ENVELOPE_BYTES = 64 * 1024  # of boundaries and headers, and
MAX_FILE_ENVELOPE_BYTES = 2 * 1024  # for each file; set by hand


@dataclass(frozen=True, slots=True)
class ReceivedMesh:
    """An uploaded mesh that is not yet accepted."""

    upload: MeshUpload
    file_name: str | None  # as given by the client, unchecked; of a set of files that of its mesh
    is_set: bool = False  # a ZIP archive of a mesh and the files that belong to it, made by the service


@dataclass(slots=True)
class Form:
    """The fields of a parsed form."""

    meshes: list[ReceivedMesh] = field(default_factory=list)
    parameters: bytearray = field(default_factory=bytearray)  # JSON text
    left_out: list[str] = field(default_factory=list)  # the names of files that are no part of a mesh


class FormReader:
    """A parser of one form, fed with the chunks of its body."""

    def __init__(
        self, boundary: bytes, begin_upload: Callable[[], MeshUpload], max_mesh_bytes: int, max_files: int
    ) -> None:
        self._begin_upload = begin_upload
        self._max_mesh_bytes = max_mesh_bytes
        self._max_files = max_files
        self._form = Form()
        self._field = ""
        self._seen: set[str] = set()
        self._header = (bytearray(), bytearray())
        self._disposition = b""
        self._is_complete = False
        self._parser = MultipartParser(boundary, self._callbacks())

    def feed(self, data: bytes) -> None:
        """Parse the next chunk.

        Raises
        ------
        Problem
            If the form is malformed, has an unknown field, or exceeds a limit.
        """
        try:
            self._parser.write(data)
        except FormParserError as error:
            raise Problem("malformed_request", "The body is not well-formed multipart/form-data.") from error

    def finish(self) -> Form:
        """Return the form after the last chunk.

        Raises
        ------
        Problem
            If the form is incomplete or has no mesh.
        """
        if not self._is_complete:
            raise Problem("malformed_request", "The form is incomplete: its last boundary is missing.")
        if not self._form.meshes:
            raise Problem("malformed_request", "The form has no field mesh: send the mesh file in it.")
        return self._form

    def _callbacks(self) -> Any:
        return {
            "on_part_begin": self._begin_part,
            "on_header_field": lambda data, start, end: self._header[0].extend(data[start:end]),
            "on_header_value": lambda data, start, end: self._header[1].extend(data[start:end]),
            "on_header_end": self._end_header,
            "on_headers_finished": self._begin_field,
            "on_part_data": self._take_data,
            "on_part_end": self._end_part,
            "on_end": self._end,
        }

    def _begin_part(self) -> None:
        self._disposition = b""

    def _end_header(self) -> None:
        name, value = self._header
        if bytes(name).lower() == b"content-disposition":
            self._disposition = bytes(value)
        self._header = (bytearray(), bytearray())

    def _begin_field(self) -> None:
        _, options = parse_options_header(self._disposition)
        self._field = options.get(b"name", b"").decode("utf-8", "replace")
        if self._field == "mesh":
            self._begin_mesh(file_name_in(self._disposition))
        elif self._field != "parameters":
            _refuse(f"The field {self._field[:80]!r} is unknown: the fields are mesh and parameters.")
        elif "parameters" in self._seen:
            _refuse("The form has two fields parameters: send one.")
        self._seen.add(self._field)

    def _begin_mesh(self, file_name: str | None) -> None:
        if len(self._form.meshes) == self._max_files:
            raise Problem("too_large", f"The form has more than {self._max_files} files: send fewer at a time.")
        self._form.meshes.append(ReceivedMesh(self._begin_upload(), file_name))

    def _take_data(self, data: bytes, start: int, end: int) -> None:
        if self._field == "mesh":
            write_capped(self._form.meshes[-1].upload, data[start:end], self._max_mesh_bytes)
            return
        self._form.parameters += data[start:end]
        if len(self._form.parameters) > MAX_PARAMETERS_BYTES:
            raise Problem("too_large", f"The field parameters is longer than {MAX_PARAMETERS_BYTES} bytes.")

    def _end_part(self) -> None:
        if self._field == "mesh":
            self._form.meshes[-1].upload.close()

    def _end(self) -> None:
        self._is_complete = True


def write_capped(upload: MeshUpload, data: bytes, max_mesh_bytes: int) -> None:
    """Append data to an upload.

    Raises
    ------
    Problem
        If the mesh becomes larger than ``max_mesh_bytes``.
    """
    if upload.size_bytes + len(data) > max_mesh_bytes:
        refuse_size(max_mesh_bytes)
    upload.write(data)


def refuse_size(max_mesh_bytes: int) -> NoReturn:
    """Raise the problem for a mesh that is too large."""
    raise Problem("too_large", f"The mesh is larger than the {max_mesh_bytes} bytes that this server accepts.")


def _refuse(sentence: str) -> NoReturn:
    raise Problem("malformed_request", sentence)
