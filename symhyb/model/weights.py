"""Weights of trained networks by their hash: in memory until a model file is written beside them.

A network that was just trained can be simulated and judged before anything is on disk. What a hash
stands for never changes, so this memory cannot make one model depend on another.
"""

import hashlib
from pathlib import Path

from symhyb.errors import InputError, Problem
from symhyb.model.types import Model, Network
from symhyb.writing import write_file

_BY_HASH: dict[str, bytes] = {}


def keep(data: bytes) -> str:
    """Keep the content of a weights file; returns its SHA-256 in hexadecimal digits."""
    digest = hashlib.sha256(data).hexdigest()
    _BY_HASH[digest] = data
    return digest


def kept(sha256: str) -> bytes | None:
    """The content with this hash, None if none was kept."""
    return _BY_HASH.get(sha256)


def write_weights(model: Model, target: Path) -> None:
    """Put the weights of all networks of ``model`` where the model file ``target`` looks for them.

    Weights that are nowhere to be found are left out: whoever builds the model is informed.

    Raises:
        InputError: a file of that name with other content is there, or one cannot be written.
    """
    for element in model.elements:
        if element.network is not None:
            _write(element.network, Path(model.file).parent, target.parent)


def _write(network: Network, home: Path, folder: Path) -> None:
    place = folder / network.weights
    there = _content(place)
    data = kept(network.sha256) or _content(home / network.weights)
    if data is None or hashlib.sha256(data).hexdigest() != network.sha256 or data == there:
        return
    if there is not None:
        text = "holds the weights of another network; write the model into another folder"
        raise InputError(Problem(text, file=str(place)))
    write_file(place, data)


def _content(path: Path) -> bytes | None:
    try:
        return path.read_bytes()
    except OSError:
        return None
