"""Lowered CasADi functions kept on disk, so that a model seen before needs no SymPy.

    key = cache.key(model text, …)      functions = cache.load(key) or lower and cache.store(key, …)

CasADi's own ``Function.deserialize`` is not used: what it reads may name a shared library, which it
then loads and runs. A file here holds the scalar operations of each function as numbers, and a
function is built from them again, one known operation after the other; the worst that a forged
file can do is to compute something else. Damage is seen by a SHA-256 digest in front; a damaged
file is removed and counts as absent. Functions that are not made of scalar operations (``MX``,
integrators) are not kept.

    symhyb functions 1 <digest of the rest>\\n
    <length of the header, 8 bytes><header, JSON><operations, int32><constants, float64>
"""

import hashlib
import json
import os
import tempfile
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.compiled import cache_folder, forget
from symhyb.numeric.kernels.instructions import BINARY, UNARY, program

FORMAT = 1
FILES_MOST = 300
_MARK = f"symhyb functions {FORMAT} ".encode()
_DIGEST = 64  # hexadecimal digits of SHA-256

Integers = NDArray[np.int32]


def key(*parts: str | bytes) -> str:
    """The name under which the functions of a model are kept: a digest of ``parts`` (all that they
    depend on, in order), of CasADi's version, of this format and of the code that lowers."""
    return _digest(str(FORMAT), ca.CasadiMeta.version(), _lowering(), *parts)


def _digest(*parts: str | bytes) -> str:
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        digest.update(len(data).to_bytes(8, "little") + data)
    return digest.hexdigest()


@lru_cache(maxsize=1)
def _lowering() -> str:
    """What stands for symhyb's version: a digest of :func:`lowering_code`, so that a change of one
    line there, in a working copy too, makes new functions."""
    return _digest(*(file.read_bytes() for file in lowering_code()))


def lowering_code() -> tuple[Path, ...]:
    """The files of all code between a model and its functions."""
    package = Path(__file__).parents[2]
    layers = ("laws", "model", "mechanics", "numeric")
    files = [file for layer in layers for file in package.glob(f"{layer}/**/*.py")]
    return tuple(sorted([*files, package / "units.py"]))


def load(key: str) -> dict[str, ca.Function] | None:
    """The functions kept under ``key``; None if there are none, or they are damaged."""
    folder = cache_folder("functions")
    if folder is None:
        return None
    file = folder / f"{key}.functions"
    try:
        data = file.read_bytes()
    except OSError:
        return None
    functions = _read(data)
    try:
        if functions is None:
            file.unlink(missing_ok=True)
        else:
            os.utime(file)  # the files used last are the ones that stay
    except OSError:
        pass  # nothing is lost
    return functions


def store(key: str, functions: Mapping[str, ca.Function]) -> bool:
    """Keep ``functions`` under ``key``; False where that is impossible, which is no error."""
    folder, data = cache_folder("functions"), _written(functions)
    if folder is None or data is None:
        return False
    try:
        with tempfile.TemporaryDirectory(dir=folder) as work:
            file = Path(work) / "functions"
            file.write_bytes(data)
            file.replace(folder / f"{key}.functions")  # in one go: nobody reads half a file
        forget(folder, "*.functions", FILES_MOST)
    except OSError:
        return False
    return True


def _written(functions: Mapping[str, ca.Function]) -> bytes | None:
    """The file; None if a function is not made of scalar operations."""
    headers, numbers, constants = [], [], []
    for name, function in functions.items():
        code = program(function)
        if code is None:
            return None
        parts = [code.loads, [(v,) for v, _ in code.constants], code.steps, code.stores]
        headers.append(
            {
                "key": name,
                "name": function.name(),
                "inputs": _described(function.n_in(), function.name_in, function.sparsity_in),
                "outputs": _described(function.n_out(), function.name_out, function.sparsity_out),
                "size": code.size,
                "parts": [len(part) for part in parts],
            }
        )
        flat = [np.array(part, dtype="<i4").reshape(-1) for part in parts]
        numbers.append(np.concatenate(flat).astype("<i4"))
        constants.append(np.array([x for _, x in code.constants], dtype="<f8"))
    header = json.dumps(headers).encode()
    rest = len(header).to_bytes(8, "little") + header
    rest += b"".join(part.tobytes() for part in (*numbers, *constants))
    return _MARK + hashlib.sha256(rest).hexdigest().encode() + b"\n" + rest


def _described(
    count: int, name: Callable[[int], str], sparsity: Callable[[int], ca.Sparsity]
) -> list[Any]:
    """Name, rows, columns, and which entries are not zero (None: all), of inputs or outputs."""
    return [
        [name(i), *sparsity(i).size(), None if sparsity(i).is_dense() else sparsity(i).find()]
        for i in range(count)
    ]


def _read(data: bytes) -> dict[str, ca.Function] | None:
    """The functions in a file; None if it is not what was written."""
    start = len(_MARK) + _DIGEST + 1
    rest = data[start:]
    whole = _MARK + hashlib.sha256(rest).hexdigest().encode() + b"\n"
    if data[:start] != whole:
        return None
    try:
        length = int.from_bytes(rest[:8], "little")
        headers = json.loads(rest[8 : 8 + length])
        sizes = [np.dot(head["parts"], (3, 1, 4, 3)) for head in headers]
        middle = 8 + length + 4 * int(sum(sizes))
        numbers = np.frombuffer(rest[8 + length : middle], dtype="<i4")
        constants = np.frombuffer(rest[middle:], dtype="<f8")
        functions, at, constant = {}, 0, 0
        for head, size in zip(headers, sizes, strict=True):
            some = constants[constant : constant + head["parts"][1]]
            functions[str(head["key"])] = _built(head, numbers[at : at + size], some)
            at, constant = at + size, constant + some.size
    except (ValueError, KeyError, IndexError, TypeError, RuntimeError, NotImplementedError):
        return None  # a file with the right digest that this program did not write
    return functions


def _built(head: dict[str, Any], numbers: Integers, constants: NDArray[np.float64]) -> ca.Function:
    """One function, operation by operation."""
    loads, fixed, steps, stores = _split(numbers, head["parts"])
    inputs = [ca.SX.sym(name, _sparsity(*shape)) for name, *shape in head["inputs"]]
    given = [dict(zip(x.sparsity().find(), x.elements(), strict=True)) for x in inputs]
    values: list[Any] = [None] * int(head["size"])
    for value, argument, entry in loads:
        values[value] = given[argument][entry]
    for (value,), number in zip(fixed, constants.tolist(), strict=True):
        values[value] = ca.SX(number)
    for value, operation, left, right in steps:
        if operation in BINARY:
            values[value] = ca.SX.binary(operation, values[left], values[right])
        elif operation in UNARY:
            values[value] = ca.SX.unary(operation, values[left])
        else:
            raise ValueError(f"operation {operation}")
    outputs = _outputs(head, stores, values)
    names_in, names_out = ([part[0] for part in head[side]] for side in ("inputs", "outputs"))
    return ca.Function(str(head["name"]), inputs, outputs, names_in, names_out)


def _outputs(head: dict[str, Any], stores: list[list[int]], values: list[Any]) -> list[ca.SX]:
    results = []
    for i, (_, *shape) in enumerate(head["outputs"]):
        sparsity = _sparsity(*shape)
        found = {entry: values[value] for output, entry, value in stores if output == i}
        entries = [found.get(entry, ca.SX(0)) for entry in sparsity.find()]
        results.append(ca.SX(sparsity, ca.vertcat(*entries)))
    return results


def _split(numbers: Integers, parts: list[int]) -> list[list[list[int]]]:
    """Loads (value, argument, entry), constants (value), steps and stores, as lists of rows."""
    rows, at = [], 0
    for count, width in zip(parts, (3, 1, 4, 3), strict=True):
        piece = numbers[at : at + count * width].reshape(count, width)
        if piece.size and piece.min() < -1:
            raise ValueError("a negative place")
        rows.append(piece.tolist())
        at += count * width
    return rows


def _sparsity(rows: int, columns: int, entries: list[int] | None) -> ca.Sparsity:
    if entries is None:
        return ca.Sparsity.dense(rows, columns)
    return ca.Sparsity.nonzeros(rows, columns, entries)
