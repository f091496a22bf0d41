"""MATLAB files of version 5 (also called v6 and v7): vectors and single numbers."""

import io
import struct
from typing import Any

import numpy as np

from symhyb.data.table import Column, Table, refusal

_HEADER = 128  # bytes: text, version, byte order


def read_mat(content: bytes, file: str) -> Table:
    """Read the numeric vectors (N, 1) or (1, N) as columns and (1, 1) as single numbers.

    Raises:
        InputError: not a version 5 file, or cut off.
    """
    from scipy.io import loadmat

    _refuse_other_versions(content, file)
    _refuse_truncated(content, file)
    try:
        variables = loadmat(io.BytesIO(content))
    except Exception as error:  # damaged bytes make SciPy raise errors of a dozen kinds
        raise refusal(file, f"is a damaged MAT file: {error}") from error
    columns, notes = [], []
    for name, value in variables.items():
        if name.startswith("__"):
            continue
        unfit = _unfit(value)
        if unfit:
            notes.append(f"variable {name} is {unfit}: left out")
        else:
            shape = () if value.size == 1 else (value.size,)
            columns.append(Column(name, np.asarray(value, dtype=np.float64).reshape(shape)))
    return Table(file, tuple(columns), tuple(notes))


def _unfit(value: Any) -> str:
    """Say what a variable is if it is no real vector or number, else nothing."""
    if not isinstance(value, np.ndarray):
        return "no array of numbers"  # a sparse matrix, a function handle
    size = " x ".join(str(length) for length in value.shape)
    if value.dtype.kind == "O":
        return f"a cell array ({size})"
    if value.dtype.names:
        return "a structure"
    if value.dtype.kind not in "buif":
        return "complex" if value.dtype.kind == "c" else "text"
    if value.size == 0:
        return "empty"
    if value.ndim > 2 or min(value.shape) > 1:
        return f"a matrix ({size}), not a vector"
    return ""


def _refuse_other_versions(content: bytes, file: str) -> None:
    newer = content.startswith((b"\x89HDF", b"MATLAB 7.3"))
    if newer or (content.startswith(b"MATLAB") and content[512:516] == b"\x89HDF"):
        raise refusal(
            file,
            "is a MAT file of version 7.3 (HDF5), which cannot be read yet; in MATLAB, load it"
            " and save it again with save('name.mat', '-v7')",
        )
    if not content.startswith(b"MATLAB 5.0"):
        raise refusal(file, "is not a MAT file of version 5, although its name ends in .mat")


def _refuse_truncated(content: bytes, file: str) -> None:
    """Walk the elements of the file: each states its length, and the last must end at the end."""
    order = ">" if content[126:128] == b"MI" else "<"
    position = _HEADER
    while position < len(content):
        tag = content[position : position + 8]
        length = struct.unpack(f"{order}I", tag[4:])[0] if len(tag) == 8 else 0
        position += 8 + length
    if position != len(content):
        missing = position - len(content)
        raise refusal(file, f"is cut off: at least {missing} bytes are missing at its end")
    if len(content) <= _HEADER:
        raise refusal(file, "is cut off: it has a header and no variables")
