"""A result whose machine moves: the oscillator with what was found in it, along a made motion."""

from dataclasses import replace

import numpy as np
from made_results import missing
from snippets import ROOT

from symhyb.by_name import Items
from symhyb.discrepancy.results import Diagnosis, Trace, Verdict
from symhyb.model.read import read_model
from symhyb.model.types import Element, Model, On
from symhyb.report.series import Array

AMPLITUDE, FREQUENCY = 0.3, 0.5


def along(model: Model, t: Array, q: Array, ghost: Array | None = None) -> Trace:
    """An unseen recording ``t`` (N,) in s of a motion ``q`` (N, n), and that of the model as given
    (N, n), SI."""
    names = [one.name for one in model.coordinates]
    signal = {"encoder": q[:, 0]}
    return Trace(
        "run.csv",
        "holdout",
        t,
        signal,
        signal,
        signal,
        motion=dict(zip(names, q.T, strict=True)),
        motion_before={} if ghost is None else dict(zip(names, ghost.T, strict=True)),
    )


def moved(name: str = "found_friction") -> tuple[Diagnosis, Verdict, Model]:
    """The oscillator goes to and fro; the model as given does so slower, and stops after 7.5 s."""
    model = read_model(ROOT / "models" / "oscillator.toml")
    t = np.linspace(0.0, 10.0, 1001)
    q = AMPLITUDE * np.sin(2 * np.pi * FREQUENCY * t)[:, None]
    ghost = 0.5 * AMPLITUDE * np.sin(2 * np.pi * 0.8 * FREQUENCY * t)[:, None]
    ghost[t > 7.5] = np.nan
    diagnosis, verdict = missing()
    effect = replace(diagnosis.found[0], element=Element(name, "friction", On("q"), ()))
    found = replace(diagnosis, found=Items((effect,)), clouds=(), places=(), log=())
    return found, replace(verdict, traces=(along(model, t, q, ghost),)), model
