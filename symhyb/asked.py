"""Arguments of what ``import symhyb`` offers: a wrong type ends in a sentence.

One decorator reads the annotations of a function and checks what it is called with: who was called,
with what, what is expected, and what would cure it. It looks at types alone; what a value means is
judged by the function.
"""

import inspect
import os
import types
from collections.abc import Callable, Mapping, Sequence, ValuesView
from contextlib import suppress
from functools import cache, wraps
from numbers import Integral, Real
from typing import Any, Literal, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

P = ParamSpec("P")
R = TypeVar("R")
LETTERS = 40  # of a value that a message shows

_WORDS = {
    str: "a text",
    bool: "True or False",
    int: "a whole number",
    float: "a number",
    os.PathLike: "a path",
}
_CURES = {
    "Model": {
        "str": "read a model file with read_model(path), a text with parse_model(text)",
        "Path": "read it with read_model(path)",
        "Trained": "its .model is one",
        "Remainder": "its .model is one",
        "Finished": "its .model is one",
        "Learned": "its .corrected is one",
        "Machine": "its .model is one",
    },
    "Recording": {
        "str": "read it with read_recording(path, model)",
        "Path": "read it with read_recording(path, model)",
        "DataFrame": "make it one with Recording.from_frame(frame, model)",
        "dict": "make it one with Recording.from_frame(columns, model)",
        "ndarray": "name its columns: Recording.from_frame({'t': ..., ...}, model)",
        "Dataset": "make it one with Recording.from_xarray(dataset, model)",
        "DataArray": "make it one with Recording.from_xarray(dataset, model)",
        "Trajectory": "its .to_frame() can be read with Recording.from_frame(frame, model)",
    },
    "Found": {"Diagnosis": "give its .found"},
    "Reestimated": {"Diagnosis": "give its .parameters"},
    "Measurement": {"Diagnosis": "give its .measurement"},
    "Verdict": {"Comparison": "give the verdict of judge(...)"},
    "Diagnosis": {"Verdict": "the diagnosis comes before the verdict"},
}


def asked(function: Callable[P, R]) -> Callable[P, R]:
    """Check the types of the arguments of a function against its annotations when it is called.

    The wrapped function raises a TypeError with a sentence where one does not fit.
    """
    signature = inspect.signature(function)

    @wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError as error:
            text = f"{function.__name__}: {error}; it takes {signature_text(function)}"
            raise TypeError(text) from None
        hints = _hints(function)
        for name, value in given.items():
            if name in hints and not fits(value, hints[name]):
                raise TypeError(complaint(function.__name__, name, value, hints[name]))
        return function(*args, **kwargs)

    return checked


def fits(value: object, expected: Any) -> bool:
    """Whether a value is what an annotation says, as far as that can be seen at once: arrays,
    words of a list and what functions take are judged by who uses them."""
    if expected is Any:
        return True
    origin, inside = get_origin(expected), get_args(expected)
    if origin in (Union, types.UnionType):
        return any(fits(value, one) for one in inside)
    if origin is Literal:
        return isinstance(value, str)
    if expected in (float, int, bool):
        return _is_number(value, expected)
    if origin in (Sequence, tuple, list):
        return _is_row(value) and all(fits(one, inside[0]) for one in value)  # type: ignore[attr-defined]
    if origin is Mapping:
        by_name = get_args(expected)[0] is str
        return isinstance(value, Mapping) and (
            not by_name or all(isinstance(key, str) for key in value)
        )
    if expected is None or expected is type(None):
        return value is None
    if origin is Callable or expected is Callable:
        return callable(value)
    kind = origin or expected
    return isinstance(value, kind) if isinstance(kind, type) else True


def complaint(function: str, name: str, value: object, expected: Any) -> str:
    """The sentence on an argument that does not fit: what was given, what is expected, the cure."""
    wrong = value
    if _is_row(value):  # the item that is wrong says more than the list around it
        items = [inside for one in _unions(expected) for inside in get_args(one) if _is_many(one)]
        bad = [one for one in value if not any(fits(one, item) for item in items)]  # type: ignore[attr-defined]
        wrong = bad[0] if items and bad else value
    listed = list(dict.fromkeys(_said(one) for one in _unions(expected)))
    wanted = listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} or {listed[-1]}"
    within = "" if wrong is value else f" in a {type(value).__name__}"
    text = f"{function}: '{name}' must be {wanted}, not {_shown(wrong)}{within}"
    cure = _cure(wrong, expected)
    return f"{text}; {cure}" if cure else text


@cache
def signature_text(function: Callable[..., Any]) -> str:
    """The parameters of a function by name, in their order."""
    return ", ".join(inspect.signature(function).parameters)


@cache
def _hints(function: Callable[..., Any]) -> dict[str, Any]:
    """The annotations of the parameters; those that only type checkers can see are left out."""
    stated = {key: one for key, one in inspect.get_annotations(function).items() if key != "return"}
    hints: dict[str, Any] = {}
    for name, one in stated.items():
        with suppress(NameError):
            single = types.SimpleNamespace(__annotations__={name: one})
            hints |= get_type_hints(single, function.__globals__)
    return hints


def _is_number(value: object, expected: type) -> bool:
    if expected is bool:
        return isinstance(value, bool) or type(value).__name__ in ("bool", "bool_")
    kind = Integral if expected is int else Real
    return isinstance(value, kind) and not isinstance(value, bool)


def _is_row(value: object) -> bool:
    """Whether a value is several others in a row; a text is one value."""
    return isinstance(value, Sequence | ValuesView) and not isinstance(value, str | bytes)


def _is_many(expected: Any) -> bool:
    return get_origin(expected) in (Sequence, tuple, list)


def _unions(expected: Any) -> tuple[Any, ...]:
    together = get_origin(expected) in (Union, types.UnionType)
    return get_args(expected) if together else (expected,)


def _said(expected: Any) -> str:
    """An annotation in words."""
    if expected is None or expected is type(None):
        return "None"
    if _is_many(expected):
        return f"a list of {_plural(get_args(expected)[0])}"
    if get_origin(expected) is Mapping:
        return "a mapping by name" if get_args(expected)[0] is str else "a mapping"
    if get_origin(expected) is Literal:
        return f"one of {', '.join(map(repr, get_args(expected)))}"
    kind = get_origin(expected) or expected
    if kind in _WORDS:
        return _WORDS[kind]
    if kind is Callable:
        return "a function"
    return f"a {getattr(kind, '__name__', kind)}"


def _plural(expected: Any) -> str:
    if expected is str:
        return "texts"
    return " or ".join(f"{_said(one)[2:]}s" for one in _unions(expected))


def _shown(value: object) -> str:
    """A value as a message shows it: its type, and a plain one itself."""
    kind = type(value).__name__
    if value is None:
        return "None"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    if isinstance(value, str | int | float):
        text = repr(value)
        return f"{kind} {text if len(text) <= LETTERS else text[: LETTERS - 1] + '…'}"
    return f"a {kind}"


def _cure(value: object, expected: Any) -> str:
    """What turns what was given into what is expected, where that is known."""
    parts = [part for one in _unions(expected) for part in (one, *get_args(one))]
    names = [getattr(part, "__name__", "") for part in parts]
    kinds = [kind.__name__ for kind in type(value).__mro__]
    for name in names:
        for kind in ("Path" if "PurePath" in kinds else "", *kinds):
            if kind in _CURES.get(name, {}):
                return _CURES[name][kind]
    if isinstance(value, type):
        return "an object is wanted, not its class"
    if isinstance(value, str) and any(_is_many(one) for one in _unions(expected)):
        return f"write [{value!r}]" if len(value) <= LETTERS else ""
    return ""
