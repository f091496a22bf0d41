"""JSON: a mapping of columns, a list of records, or a table of rows or columns without names.

{"t": [0, 0.01], "laser [mm]": [1.5, 1.7], "dt": 0.01}
[{"t": 0, "laser": 1.5}, {"t": 0.01, "laser": 1.7}]
{"columns": ["t", "laser"], "data": [[0, 1.5], [0.01, 1.7]]}
{"data": [[0, 1.5], [0.01, 1.7]], "dt": 0.01}              columns data.1 and data.2
"""

import json
from collections import Counter
from collections.abc import Mapping
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.nested import Unfit, columns_of
from symhyb.data.files.table import Table, refusal

NAMELESS = "data"  # how the vectors of a table without names are called: data.1, data.2, …


def read_json(content: bytes, file: str) -> Table:
    """Read the columns (N,) and single numbers () of a JSON file; null is a missing sample.

    Raises:
        InputError: no JSON, cut off, the same key twice, or nothing that could be a column.
    """
    try:
        value = json.loads(content, object_pairs_hook=_pairs)
    except json.JSONDecodeError as error:
        text = f"is no JSON, or cut off: {error.msg} in column {error.colno}"
        raise refusal(file, text, error.lineno) from error
    except UnicodeDecodeError as error:
        raise refusal(file, "is not a text file, although its name ends in .json") from error
    except RecursionError as error:
        raise refusal(file, "is nested too deeply") from error
    except ValueError as error:
        raise refusal(file, f"cannot be used: {error}") from error
    tree = _tree(value)
    if not isinstance(tree, Mapping):
        tree = {NAMELESS: tree}
    columns, notes = columns_of(tree)
    if not columns:
        why = "".join(f"; {note}" for note in notes)
        raise refusal(file, f"holds no column of numbers{why}")
    return Table(file, columns, notes)


def _pairs(pairs: list[tuple[str, object]]) -> dict[str, object]:
    values = dict(pairs)
    if len(values) < len(pairs):
        often = Counter(name for name, _ in pairs)
        twice = next(name for name, count in often.items() if count > 1)
        raise ValueError(f"the key '{twice}' stands more than once")
    return values


def _tree(value: object) -> object:
    """Turn a JSON value into mappings, lists, arrays and :class:`Unfit`."""
    if isinstance(value, dict):
        # A single text (a title, a unit) is about the data; it is no column that was left out.
        fields = {key: item for key, item in value.items() if not isinstance(item, str)}
        return _named(value) or {key: _tree(item) for key, item in fields.items()}
    if isinstance(value, list):
        return _list(value)
    number = _number(value)
    return Unfit("text" if isinstance(value, str) else "empty") if number is None else number


def _named(value: Mapping[str, object]) -> dict[str, object] | None:
    """Give the columns of ``data`` the names under ``columns``, as many programs write them."""
    names, rows = value.get("columns"), value.get("data")
    if not isinstance(names, list) or not isinstance(rows, list) or not rows:
        return None
    if not all(isinstance(name, str) for name in names):
        return None
    if not all(isinstance(row, list) and len(row) == len(names) for row in rows):
        return None
    rest = {key: _tree(item) for key, item in value.items() if key not in ("columns", "data")}
    return rest | {name: _list([row[k] for row in rows]) for k, name in enumerate(names)}


def _list(items: list[object]) -> object:
    """Turn a list into a vector, records into columns, equally long lists into a matrix."""
    if not items:
        return Unfit("empty")
    if all(isinstance(item, dict) for item in items):
        keys = dict.fromkeys(chain.from_iterable(item for item in items if isinstance(item, dict)))
        plain = not any(isinstance(one, list | dict) for item in items for one in _values(item))
        if plain:
            return {key: _list([_get(item, key) for item in items]) for key in keys}
        return [_tree(item) for item in items]
    if any(isinstance(item, list | dict) for item in items):
        parts = [_tree(item) for item in items]
        flat = all(isinstance(part, np.ndarray) and part.ndim == 1 for part in parts)
        if flat and len({part.size for part in parts if isinstance(part, np.ndarray)}) == 1:
            return np.array(parts)
        return parts
    numbers = [np.nan if item is None else _number(item) for item in items]
    if any(number is None for number in numbers):
        return Unfit("text")
    vector = np.array(numbers, dtype=np.float64)
    return Unfit("empty") if np.isnan(vector).all() else vector


def _values(item: object) -> list[object]:
    return list(item.values()) if isinstance(item, dict) else []


def _get(item: object, key: str) -> object:
    return item.get(key) if isinstance(item, dict) else None


def _number(value: object) -> NDArray[np.float64] | None:
    """Return a number or a flag, None for anything else; 10^400 is infinite, as in a CSV file."""
    if not isinstance(value, bool | int | float):
        return None
    try:
        return np.array(float(value))
    except OverflowError:
        return np.array(np.inf if value > 0 else -np.inf)
