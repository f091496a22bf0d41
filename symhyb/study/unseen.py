"""That unseen recordings of a study are unseen."""

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.errors import InputError, Problem


def require_unseen(train: Sequence[Recording], holdout: Sequence[Recording]) -> None:
    """See that no sample of an unseen recording is in one that is learned from.

    Raises:
        InputError: the first that is.
    """
    for seen, unseen in product(train, holdout):
        common = seen.common(unseen)
        if common.size:
            raise InputError(Problem(_seen_before(common, unseen), "holdout", unseen.name))


def _seen_before(common: NDArray[np.float64], unseen: Recording) -> str:
    """Say that ``common`` times (K,) of an unseen recording are in a training recording, and the
    cure: a span includes the samples at both its ends."""
    why = "what is learned from cannot prove anything"
    if common.size == unseen.t.size:
        return f"is a training recording too; {why}"
    if common.size > 1:
        stretch = f"{common[0]:g} … {common[-1]:g} s"
        return f"{stretch} of it are in a training recording too; {why}; let the spans not overlap"
    behind = unseen.t[unseen.t > common[0]]
    cure = "let one span end before it"
    if behind.size and common[0] == unseen.t[0]:
        cure = f"begin this span behind it, as in [{(common[0] + behind[0]) / 2:.9g}, …]"
    return (
        f"its sample at {common[0]:.9g} s is in a training recording too, for a span includes the"
        f" samples at both its ends; {cure}"
    )
