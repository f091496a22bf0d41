"""A diagnosis of models/oscillator.toml made by hand, in the place of one that takes long."""

from collections.abc import Callable

import numpy as np
import pytest

from symhyb.diagnosis import Concluded
from symhyb.discrepancy.results import (
    Alternative,
    Comparison,
    Diagnosis,
    Estimate,
    Found,
    Score,
    Trace,
    Verdict,
)
from symhyb.model.expression import parse_expression
from symhyb.model.types import Element, On, Parameter
from symhyb.study import run as study
from symhyb.units import parse_unit

NOTHING = Diagnosis("nothing missing", "Nothing is missing.", remainder=1.0)


def friction(coulomb: float = 0.4905) -> Diagnosis:
    """Coulomb friction on q of the oscillator, with a rival."""
    unit = parse_unit("N")
    own = Parameter("F_c", coulomb, unit, 0.006, owner="found_friction")
    element = Element(
        "found_friction", "friction", On("q"), (("coulomb", parse_expression("F_c")),), (own,)
    )
    effect = Found(
        element,
        "coulomb*tanh(s'/transition)",
        (Estimate("F_c", coulomb, 0.006, "N", "coulomb"),),
        0.4,
        "q lacks friction.",
    )
    rival = Alternative(
        "found_friction", "offset", (Estimate("o", 0.1, 0.01, "N", "offset"),), 3.0, channel="f"
    )
    return Diagnosis(
        "missing physics",
        "On q the model lacks dry friction.",
        (effect,),
        alternatives=(rival,),
        record_next="Record a slower sine.",
        remainder=0.02,
        noise={"position": 0.0085},
        notes=("a note on the recording",),
    )


def score(size: float) -> Score:
    """The same error everywhere: a part of the range, and in the sensor's unit."""
    sensors, absolute = {"position": size, "speed": size}, {"position": size, "speed": size}
    return Score({"q": size}, {"q": size}, sensors, absolute, sensors, absolute)


def verdict(before: float = 0.05, after: float = 0.0074) -> Verdict:
    """Scores before and after, and a short trace."""
    t = np.linspace(0.0, 1.0, 50)
    signals = {"position": np.sin(t), "speed": np.cos(t)}
    trace = Trace("holdout.csv", "holdout", t, signals, signals, signals)
    change = Comparison(score(before), score(after))
    return Verdict(0.5, "fitted", 10.0, change, change, "The windows carry the verdict.", (trace,))


Fake = Callable[..., list[tuple[object, ...]]]


def fake_diagnosis(monkeypatch: pytest.MonkeyPatch) -> Fake:
    """Return ``fake(diagnosis, error)``: from then on a study gets this diagnosis, or this error.

    It returns the list of the arguments with which a diagnosis was asked for.
    """

    def fake(
        diagnosis: Diagnosis = NOTHING, error: BaseException | None = None
    ) -> list[tuple[object, ...]]:
        asked: list[tuple[object, ...]] = []

        def conclude(
            *arguments: object,
            say: Callable[[str], None],
            own: tuple[str, ...] = (),
            deadline: object = None,
        ) -> Concluded:
            asked.append(arguments)
            say("trying [friction] on q")
            if error is not None:
                raise error
            return Concluded(diagnosis)

        monkeypatch.setattr(study, "conclude", conclude)
        monkeypatch.setattr(study, "judge", lambda *_, **__: verdict())
        return asked

    return fake
