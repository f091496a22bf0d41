"""What is handed to a process apart, as bytes: words as JSON, and arrays by name."""

import io
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray


def packed(words: Any, **arrays: NDArray[Any]) -> bytes:
    """Words that JSON has, and arrays (…) of any shapes and units, as bytes."""
    out = io.BytesIO()
    held: dict[str, Any] = {"words": np.frombuffer(json.dumps(words).encode(), np.uint8), **arrays}
    np.savez(out, **held)
    return out.getvalue()


def unpacked(content: bytes) -> tuple[Any, dict[str, NDArray[Any]]]:
    """The words and the arrays (…), with their shapes, in the units they were given in; none of
    what they hold is executed."""
    with np.load(io.BytesIO(content), allow_pickle=False) as held:
        arrays = {name: held[name] for name in held.files}
    return json.loads(arrays.pop("words").tobytes()), arrays
