"""MATLAB files of version 7.3, which are HDF5: the same variables as in version 5.

MATLAB stores arrays by columns and HDF5 reads them by rows, so every array arrives transposed.
Cells, and the fields of an array of structures, are references to values elsewhere in the file.
"""

import io
from collections.abc import Callable
from typing import Any

import numpy as np

from symhyb.data.files.extras import first_line, needed
from symhyb.data.files.nested import Unfit, columns_of
from symhyb.data.files.table import Table, refusal
from symhyb.limits import STRUCTURES_DEEP, VARIABLE_NUMBERS

_MAGIC = b"\x89HDF\r\n\x1a\n"
_USER_BLOCK = 512  # bytes of MATLAB's own header before the HDF5 file begins


def is_newer(content: bytes) -> bool:
    """Say whether these are the bytes of a file of version 7.3."""
    inside = content[_USER_BLOCK : _USER_BLOCK + 8] == _MAGIC
    return content.startswith((_MAGIC, b"MATLAB 7.3")) or inside


def read_mat73(content: bytes, file: str) -> Table:
    """Read the vectors and numbers of a file of version 7.3.

    Raises:
        InputError: h5py is not installed, or the file is cut off or damaged.
    """
    h5py = needed("h5py", "mat73", file)
    try:
        with h5py.File(io.BytesIO(content), "r") as archive:
            tree = _group(archive, archive, h5py, 0)
    except Exception as error:  # damaged bytes make HDF5 raise errors of many kinds
        why = first_line(error) or type(error).__name__
        text = f"is a damaged or cut off MAT file of version 7.3: {why}"
        raise refusal(file, text) from error
    return Table(file, *columns_of(tree))


def _group(group: Any, archive: Any, h5py: Any, depth: int) -> dict[str, object]:
    """Read a group, which is a structure; links into other files are not followed."""
    fields: dict[str, object] = {}
    for name in group:
        if name.startswith("#"):
            continue  # #refs# and #subsystem#: where MATLAB keeps what cells refer to
        if isinstance(group.get(name, getlink=True), h5py.HardLink):
            fields[name] = _value(group[name], archive, h5py, depth + 1)
        else:
            fields[name] = Unfit("a link to something else")
    return fields


def _value(item: Any, archive: Any, h5py: Any, depth: int) -> object:
    """Read one variable, field or cell."""
    if depth > STRUCTURES_DEEP:
        return Unfit("nested too deeply")
    if isinstance(item, h5py.Group):
        return _structure(item, archive, h5py, depth)
    if not isinstance(item, h5py.Dataset):
        return Unfit("no array of numbers")
    if item.external or item.is_virtual:
        return Unfit("kept in another file")
    kind = _kind(item)
    if kind == "char":
        return Unfit("text")
    if item.attrs.get("MATLAB_empty", 0) or item.size in (0, None):
        return Unfit("empty")
    if item.size > VARIABLE_NUMBERS:
        return Unfit("too large")
    if item.dtype.kind == "O":
        if h5py.check_ref_dtype(item.dtype) is None:
            return Unfit("text")
        return _deref(item, lambda one: _value(one, archive, h5py, depth + 1), archive)
    if item.dtype.names:
        return Unfit("complex" if set(item.dtype.names) == {"real", "imag"} else "a table")
    return np.asarray(item[()]).T


def _structure(group: Any, archive: Any, h5py: Any, depth: int) -> object:
    """Read a structure, or an array of structures: there every field is an array of references."""
    if "MATLAB_sparse" in group.attrs or _kind(group) not in ("struct", ""):
        return Unfit("no array of numbers")
    sizes = {
        item.size if _is_references(item, h5py) else 0 for item in group.values()
    }  # a field that is itself a cell array says so
    fields = _group(group, archive, h5py, depth)
    count = max(sizes, default=0)
    if len(sizes) != 1 or count < 1 or not all(isinstance(f, list) for f in fields.values()):
        return fields
    return [{name: cells[k] for name, cells in fields.items()} for k in range(count)]  # type: ignore[index]


def _is_references(item: Any, h5py: Any) -> bool:
    dataset = isinstance(item, h5py.Dataset) and item.dtype.kind == "O"
    return dataset and _kind(item) != "cell"


def _deref(item: Any, read: Callable[[Any], object], archive: Any) -> list[object]:
    """Follow the references of an array; as rows of the transposed array they are in order."""
    return [read(archive[one]) if one else Unfit("empty") for one in item[()].ravel()]


def _kind(item: Any) -> str:
    """Return the class that MATLAB states, empty if another program wrote the file."""
    stated = item.attrs.get("MATLAB_class", b"")
    return stated.decode("ascii", "replace") if isinstance(stated, bytes) else str(stated)
