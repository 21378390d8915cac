"""Files that the program wrote, as arrays: numpy's where numpy is installed, else memoryviews of the same shape.

A memoryview is indexed alike (`labels[x, y, z]`), has `shape` and `format`, and goes into `numpy.asarray` or `torch.frombuffer` without a copy.
"""

from __future__ import annotations

import array
import ast
import importlib.util
import os
import struct
import sys
import zipfile
import zlib
from typing import Any, Sequence, TypeAlias

Array: TypeAlias = Any  # numpy.ndarray or memoryview

# Types of .npy files by the letters of the module struct.
LETTERS = {"|u1": "B", "|i1": "b", "|b1": "?", "<u2": "H", "<i2": "h", "<u4": "I", "<i4": "i", "<f4": "f", "<f8": "d"}
# Types of properties of PLY files.
PROPERTIES = {"uchar": "B", "char": "b", "ushort": "H", "short": "h", "uint": "I", "int": "i", "float": "f", "double": "d"}


def _made(values: bytes | bytearray, letter: str, shape: tuple[int, ...]) -> Array:
    if sys.byteorder != "little":
        raise ValueError("files are little-endian, and this machine is not")
    if importlib.util.find_spec("numpy"):
        import numpy

        return numpy.frombuffer(bytearray(values), dtype=numpy.dtype(letter)).reshape(shape)
    view = memoryview(bytearray(values))
    # (a view of one axis needs no shape, and one without places can have none)
    return view.cast(letter) if len(shape) == 1 or 0 in shape else view.cast(letter, list(shape))


def npy(content: bytes) -> Array:
    """The array of an .npy file. Errors (ValueError) if it is none, or of a kind that the program does not write."""
    if content[:6] != b"\x93NUMPY" or content[6:7] not in (b"\x01", b"\x02", b"\x03"):
        raise ValueError("no .npy file")
    wide = content[6] > 1
    start = 12 if wide else 10
    (length,) = struct.unpack("<I" if wide else "<H", content[8:start])
    head = ast.literal_eval(content[start : start + length].decode("latin1"))
    letter, shape = LETTERS.get(head["descr"]), tuple(head["shape"])
    if letter is None or head["fortran_order"]:
        raise ValueError(f"an array of type {head['descr']!r} in order {'F' if head['fortran_order'] else 'C'}, expected one of {', '.join(LETTERS)} in order C")
    return _made(content[start + length :], letter, shape)


def npz(path: str | os.PathLike[str]) -> dict[str, Array]:
    """The arrays of an .npz file by name."""
    with zipfile.ZipFile(path) as archive:
        return {name.removesuffix(".npy"): npy(archive.read(name)) for name in archive.namelist()}


def ply(path: str | os.PathLike[str]) -> dict[str, Array]:
    """The properties of the vertices of a binary PLY file by name, an array each. Errors (ValueError) if it is another kind."""
    with open(path, "rb") as file:
        content = file.read()
    end = content.find(b"end_header\n")
    lines = content[: max(end, 0)].decode("ascii", "replace").splitlines()
    if lines[:2] != ["ply", "format binary_little_endian 1.0"]:
        raise ValueError(f"{os.fspath(path)}: no binary little-endian PLY file")
    count, names, letters = 0, [], ""
    for words in (line.split() for line in lines):
        if words[0] == "element":
            if words[1] != "vertex":
                raise ValueError(f"{os.fspath(path)}: has elements {words[1]}, expected vertices alone")
            count = int(words[2])
        elif words[0] == "property":
            letters += PROPERTIES[words[1]]
            names.append(words[2])
    row = struct.Struct("<" + letters)
    body = content[end + len(b"end_header\n") :][: count * row.size]
    columns = list(zip(*row.iter_unpack(body))) or [()] * len(names)
    return {n: _made(array.array(letter, of).tobytes(), letter, (count,)) for n, letter, of in zip(names, letters, columns)}


def stacked(rows: Sequence[Sequence[float]], width: int | None = None) -> Array:
    """Rows of `width` numbers as one array f64 [rows, width]; without a width rows of one number as f64 [rows]."""
    shape = (len(rows),) if width is None else (len(rows), width)
    return _made(array.array("d", (value for row in rows for value in row)).tobytes(), "d", shape)


def png(content: bytes) -> Array:
    """The pixels of a PNG file of 8 bits a channel, u8 [height, width, channels], without transparency. Errors (ValueError) if it is another kind."""
    if content[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError("no PNG file")
    at, packed, head = 8, [], b""
    while at + 8 <= len(content):
        length, kind = struct.unpack(">I4s", content[at : at + 8])
        head = content[at + 8 : at + 8 + length] if kind == b"IHDR" else head
        if kind == b"IDAT":
            packed.append(content[at + 8 : at + 8 + length])
        at += length + 12
    width, height, depth, color, _, _, interlaced = struct.unpack(">IIBBBBB", head)
    channels = {0: 1, 2: 3, 4: 2, 6: 4}.get(color)
    if depth != 8 or channels is None or interlaced:
        raise ValueError(f"a PNG file of {depth} bits, type {color}, expected 8 bits of grey or colour, not interlaced")
    row, rows = width * channels, zlib.decompress(b"".join(packed))
    if len(rows) != (row + 1) * height:
        raise ValueError(f"a PNG file with {len(rows)} bytes of pixels, expected {(row + 1) * height}")
    out, before = bytearray(), bytes(row)
    for y in range(height):
        start = y * (row + 1)
        before = _unfiltered(rows[start], bytearray(rows[start + 1 : start + 1 + row]), before, channels)
        out += before
    if channels in (2, 4):
        del out[channels - 1 :: channels]
    return _made(out, "B", (height, width, channels - (channels in (2, 4))))


def _unfiltered(kind: int, row: bytearray, up: bytes | bytearray, step: int) -> bytearray:
    """A row of a PNG file without its filter (PNG specification, 9.2), given the row above."""
    if kind == 1:
        for i in range(step, len(row)):
            row[i] = (row[i] + row[i - step]) & 255
    elif kind == 2:
        for i, above in enumerate(up):
            row[i] = (row[i] + above) & 255
    elif kind == 3:
        for i, above in enumerate(up):
            row[i] = (row[i] + ((above + (row[i - step] if i >= step else 0)) >> 1)) & 255
    elif kind == 4:
        for i, b in enumerate(up):
            a, c = (row[i - step], up[i - step]) if i >= step else (0, 0)
            from_a, from_b, from_c = abs(b - c), abs(a - c), abs(a + b - c - c)
            best = a if from_a <= from_b and from_a <= from_c else b if from_b <= from_c else c
            row[i] = (row[i] + best) & 255
    elif kind:
        raise ValueError(f"a PNG file with filter {kind}, expected 0 to 4")
    return row
