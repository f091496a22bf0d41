"""What is known of a parameter in each recording, as of a weight that is changed between runs."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.types import Model, Parameter

if TYPE_CHECKING:
    from symhyb.data.recording import Recording

CURE = "leave out one of both"


def known_in(model: Model, given: Mapping[str, object] | None, name: str) -> dict[str, float]:
    """The values ``given`` by the path of a parameter, in the units of the model, in SI: what is
    known of the recording ``name``.

    Raises:
        InputError: names that are no parameters of the model, or that may be estimated; values
            that are no finite numbers.
    """
    declared, found = {item.path: item for item in model.all_parameters()}, {}
    problems: list[Problem] = []
    for path, value in (given or {}).items():
        place = f"parameters.{path}"
        wrong = unusable(path, declared)
        if wrong:
            problems.append(Problem(wrong, place, name))
        elif isinstance(value, bool) or not isinstance(value, (int, float)):
            text = f"must be a number in {unit_text(declared[path])}, not {value!r}"
            problems.append(Problem(text, place, name))
        elif not math.isfinite(value):
            problems.append(Problem(f"must be finite, not {value}", place, name))
        else:
            found[path] = float(value) * declared[path].unit.factor
    if problems:
        raise InputError(problems)
    return found


def known_note(model: Model, known: Mapping[str, float]) -> str:
    """Say what is known of a recording, from values in SI."""
    declared = {item.path: item for item in model.all_parameters()}
    said = []
    for path, value in known.items():
        item = declared[path]
        said.append(f"{path} = {value / item.unit.factor:.6g} {item.unit.text}".strip())
    return f"known here: {', '.join(said)}"


def require_known(
    model: Model, recordings: Sequence["Recording"], fitted: Sequence[str] = ()
) -> None:
    """See that all recordings know their own values of the same parameters of the model, none of
    which is ``fitted``.

    Raises:
        InputError: a parameter that the model has not, that may be estimated or is fitted, or whose
            value only some of the recordings know.
    """
    declared = {item.path: item for item in model.all_parameters()}
    paths = dict.fromkeys(path for one in recordings for path in one.parameters)
    problems: dict[Problem, None] = {}
    for path in paths:
        wrong = unusable(path, declared)
        if not wrong and path in fitted:
            wrong = f"is to be fitted, but recordings state known values of it; {CURE}"
        if wrong:
            problems[Problem(wrong, f"parameters.{path}", model.file)] = None
            continue
        for one in recordings:
            if path not in one.parameters:
                text = "is not stated here, but for other recordings; state it for all of them"
                problems[Problem(text, f"parameters.{path}", one.name)] = None
    if problems:
        raise InputError(problems)


def unusable(path: str, declared: Mapping[str, Parameter]) -> str:
    """Why a recording cannot know a parameter; empty if it can."""
    if path not in declared:
        return f"there is no parameter '{path}' in the model{did_you_mean(path, list(declared))}"
    if declared[path].sd is not None:
        return f"states an sd in the model, so that it is estimated, and a known value; {CURE}"
    return ""


def unit_text(item: Parameter) -> str:
    """The unit of a parameter, in words."""
    return item.unit.text or "1"
