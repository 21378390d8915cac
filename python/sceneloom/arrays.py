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
from typing import Any, TypeAlias

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
