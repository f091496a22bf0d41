"""Wrong types of arguments: what was given, what is expected, and the cure, in a sentence."""

from collections.abc import Callable, Mapping, Sequence
from inspect import signature
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd
import pytest
from builders import DRIVEN_MASS
from fakes import friction, verdict

import symhyb as sh
from symhyb.asked import _hints, asked, complaint, fits

MODEL = sh.parse_model(DRIVEN_MASS)
T = np.linspace(0.0, 1.0, 50)
RUN = sh.Recording("run", T, {"f": 0 * T}, {"laser": np.sin(T)})
FRAME = RUN.to_frame()


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (1, float),
        (np.float64(1.5), float | None),
        (None, float | None),
        (np.int64(3), int),
        (np.bool_(True), bool),
        ("x", Literal["x", "y"]),
        ((), Sequence[str]),
        (["a"], Sequence[str]),
        ({"a": RUN}.values(), sh.Recording | Sequence[sh.Recording]),
        (RUN, sh.Recording | Sequence[sh.Recording]),
        ({"a": 1}, Mapping[str, float] | None),
        (print, Callable[[str], None]),
        (Path("x"), str | Path),
        (object(), Any),
    ],
)
def test_what_fits(value: object, expected: Any) -> None:
    assert fits(value, expected)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("1", float),
        (True, float),
        (2.0, int),
        (1, bool),
        (3, Literal["x", "y"]),
        ("a", Sequence[str]),
        ([1], Sequence[str]),
        ([RUN, "b"], Sequence[sh.Recording]),
        (["a"], Mapping[str, float]),
        ("print", Callable[[str], None]),
        (None, str | Path),
        (FRAME, sh.Recording),
    ],
)
def test_what_does_not(value: object, expected: Any) -> None:
    assert not fits(value, expected)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda: sh.diagnose(MODEL, "a.csv"),
            "diagnose: 'recordings' must be a Recording or a list of Recordings, not str 'a.csv'; "
            "read it with read_recording(path, model)",
        ),
        (
            lambda: sh.diagnose(MODEL, [RUN, FRAME]),
            "diagnose: 'recordings' must be a Recording or a list of Recordings, not a DataFrame "
            "in a list; make it one with Recording.from_frame(frame, model)",
        ),
        (
            lambda: sh.compare(RUN, MODEL),
            "compare: 'machine' must be a Machine or a Model, not a Recording",
        ),
        (
            lambda: sh.judge("m.toml", MODEL, on=RUN),
            "judge: 'model' must be a Model or a Machine, not str 'm.toml'; read a model file with "
            "read_model(path), a text with parse_model(text)",
        ),
        (
            lambda: sh.apply(MODEL, friction()),
            "apply: 'found' must be a list of Founds, not a Diagnosis; give its .found",
        ),
        (
            lambda: sh.diff(MODEL, sh.build(MODEL)),
            "diff: 'second' must be a Model, not a Machine; its .model is one",
        ),
        (
            lambda: sh.simulate(MODEL, end="5"),
            "simulate: 'end' must be a number or None, not str '5'",
        ),
        (
            lambda: sh.diagnose(MODEL, RUN, own="k"),
            "diagnose: 'own' must be a list of texts or a mapping by name, not str 'k'; "
            "write ['k']",
        ),
        (
            lambda: sh.diagnose(MODEL),
            "diagnose: missing a required argument: 'recordings'; it takes model, recordings, "
            "holdout, own, say, budget",
        ),
        (
            lambda: sh.write_report("r.html", verdict(), verdict()),
            "write_report: 'diagnosis' must be a Diagnosis, not a Verdict; the diagnosis comes "
            "before the verdict",
        ),
        (
            lambda: sh.build(sh.Model),
            "build: 'model' must be a Model, not the class Model; an object is wanted, not its "
            "class",
        ),
        (
            lambda: sh.read_model(None),
            "read_model: 'path' must be a text or a Path, not None",
        ),
    ],
)
def test_a_wrong_type_ends_in_a_sentence(call: Callable[[], object], said: str) -> None:
    with pytest.raises(TypeError) as caught:
        call()
    assert str(caught.value) == said
    assert caught.value.__cause__ is None


def test_every_function_that_is_exported_checks_its_arguments() -> None:
    functions = [
        getattr(sh, name) for name in sh.__all__ if not isinstance(getattr(sh, name), type)
    ]
    assert len(functions) > 15
    for function in functions:
        hints = _hints(function.__wrapped__)
        assert set(hints) == set(signature(function).parameters), function.__name__
        # anything may come where the function itself says what it takes
        first, expected = next(pair for pair in hints.items() if pair[1] is not object)
        with pytest.raises(TypeError, match=f"{function.__name__}: '{first}' must be"):
            function(*([object()] * _needed(function)))
        assert complaint(function.__name__, first, object(), expected).endswith("not a object")


def _needed(function: Callable[..., object]) -> int:
    """How many arguments must be given in order."""
    return sum(
        one.default is one.empty and one.kind is one.POSITIONAL_OR_KEYWORD
        for one in signature(function).parameters.values()
    )


def test_what_fits_is_passed_on_unchanged() -> None:
    @asked
    def kept(one: float, *, two: Sequence[str] = ()) -> tuple[object, object]:
        """Return what came."""
        return one, two

    assert kept(1, two=["a"]) == (1, ["a"])
    assert kept.__doc__ == "Return what came."
    assert kept.__name__ == "kept"


def test_pandas_is_not_needed_to_say_that_a_frame_is_none() -> None:
    assert isinstance(FRAME, pd.DataFrame)
    with pytest.raises(TypeError, match="from_frame"):
        sh.compare(MODEL, FRAME)
