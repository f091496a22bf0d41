"""Samples that make a recording: as many of each as there are times, and their digest."""

import hashlib
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from symhyb.errors import InputError, Problem

if TYPE_CHECKING:
    from symhyb.data.recording import Recording

Signals = Mapping[str, NDArray[np.float64]]


def require_samples(recording: "Recording") -> None:
    """Turn what is not yet an array of numbers into one, and refuse what is no recording.

    Raises:
        InputError: channels of another length than the time, or with no numbers; time that is not
            finite or does not increase.
    """
    problems: list[Problem] = []

    def numbers(values: object, place: str) -> NDArray[np.float64]:
        try:
            return np.asarray(values, dtype=np.float64)
        except (TypeError, ValueError):
            text = f"must be numbers, not {type(values).__name__}"
            problems.append(Problem(text, place, recording.name))
            return np.empty(0)

    t = numbers(recording.t, "t")
    object.__setattr__(recording, "t", t)
    for role in ("inputs", "sensors"):
        group = getattr(recording, role)
        if not isinstance(group, Mapping):
            text = f"must map names to signals, not be {type(group).__name__}"
            problems.append(Problem(text, role, recording.name))
            continue
        made = {name: numbers(values, f"{role}.{name}") for name, values in group.items()}
        object.__setattr__(recording, role, made)
        problems += [
            Problem(f"has shape {values.shape}; t has {t.shape}", f"{role}.{name}", recording.name)
            for name, values in made.items()
            if values.shape != t.shape
        ]
    if t.ndim != 1:
        problems.append(Problem(f"must be (N,), not {t.shape}", "t", recording.name))
    elif not (np.isfinite(t).all() and (np.diff(t) > 0).all()):
        at = int(np.argmin(np.concatenate([np.isfinite(t[:1]), np.diff(t) > 0])))
        text = f"must increase: sample {at} is {t[at]:.9g} s"
        problems.append(Problem(text, "t", recording.name))
    if problems:
        raise InputError(dict.fromkeys(problems))


def digest(t: NDArray[np.float64], inputs: Signals, sensors: Signals) -> str:
    """SHA-256 of ``t`` (N,) in s and all signals (N,) in SI with their names: what stands for the
    digest of a file where there is none."""
    found = hashlib.sha256()
    for role, group in (("t", {"t": t}), ("inputs", inputs), ("sensors", sensors)):
        for name in sorted(group):
            found.update(f"{role}/{name}/{group[name].size}:".encode())
            found.update(np.ascontiguousarray(group[name]).tobytes())
    return found.hexdigest()
