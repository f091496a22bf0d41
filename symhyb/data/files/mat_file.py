"""MATLAB files of version 5 (also called v6 and v7): vectors, numbers, structures and cells."""

import io
import struct
from typing import Any

import numpy as np

from symhyb.data.files.mat73_file import is_newer, read_mat73
from symhyb.data.files.nested import Unfit, columns_of
from symhyb.data.files.table import Table, refusal

_HEADER = 128  # bytes: text, version, byte order


def read_mat(content: bytes, file: str) -> Table:
    """Read the vectors and numbers of a MAT file of any version (:mod:`symhyb.data.files.nested`).

    Raises:
        InputError: not a MAT file, or cut off, or damaged.
    """
    if is_newer(content):
        return read_mat73(content, file)
    from scipy.io import loadmat

    if not content.startswith(b"MATLAB 5.0"):
        raise refusal(file, "is not a MAT file of version 5 or 7.3, although its name ends in .mat")
    _refuse_truncated(content, file)
    try:
        variables = loadmat(io.BytesIO(content))
    except Exception as error:  # damaged bytes make SciPy raise errors of a dozen kinds
        raise refusal(file, f"is a damaged MAT file: {error}") from error
    own = {name: _tree(value) for name, value in variables.items() if not name.startswith("__")}
    return Table(file, *columns_of(own))


def _tree(value: Any) -> object:
    """Turn what SciPy made of a variable into mappings, lists, arrays and :class:`Unfit`."""
    from scipy.io.matlab import MatlabFunction, MatlabOpaque

    if isinstance(value, MatlabFunction | MatlabOpaque):
        return Unfit("an object of MATLAB")
    if not isinstance(value, np.ndarray):
        return Unfit("no array of numbers")  # a sparse matrix
    if value.dtype.names:
        fields = [
            {name: _tree(one[name]) for name in value.dtype.names} for one in value.ravel("F")
        ]
        return fields[0] if len(fields) == 1 else fields
    if value.dtype.kind == "O":
        return [_tree(one) for one in value.ravel("F")]
    return value


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
