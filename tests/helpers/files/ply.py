"""PLY files composed from rows of values."""

import struct

ENCODINGS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
TYPES = {"char": "b", "uint8": "B", "short": "h", "uint16": "H", "int": "i", "uint32": "I", "float": "f", "double": "d"}
Rows = list[list[float | list[float]]]
Properties = list[tuple[str, ...]]


def ply(encoding: str, elements: list[tuple[str, Properties, Rows]], newline: str = "\n", comment: str = "") -> bytes:
    """A PLY file; a property is (type, name) or ("list", count type, type, name)."""
    header = ["ply", f"format {encoding} 1.0", f"comment {comment}", "obj_info by hand"]
    body = b""
    for name, properties, rows in elements:
        header += [f"element {name} {len(rows)}", *("property " + " ".join(entry) for entry in properties)]
        body += b"".join(row_bytes(properties, row, ENCODINGS[encoding]) for row in rows)
    return newline.join([*header, "end_header", ""]).encode() + body


def row_bytes(properties: Properties, row: list[float | list[float]], order: str) -> bytes:
    values: list[tuple[str, float]] = []
    for entry, value in zip(properties, row, strict=True):
        if isinstance(value, list):
            values += [(entry[1], len(value)), *((entry[2], item) for item in value)]
        else:
            values.append((entry[0], value))
    if not order:
        return (" ".join(repr(value) for _, value in values) + "\n").encode()
    return b"".join(struct.pack(order + TYPES[kind], value) for kind, value in values)
