"""A characteristic curve: a memoryless force over the stretch or over its rate, given by points."""

from collections.abc import Collection, Sequence

from symhyb.laws.base import LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase

OVER = {"stretch": "s", "rate": "s'"}
_VALUE = "f"  # of the names of unknown values
_TOLD = 5  # points whose values a sentence tells
_DIGITS = 3  # of where they are
_BENT = 2.0  # times: the mean slope of the outer half over that of the inner half, or the reverse


def value_name(which: int) -> str:
    """The name of an unknown value of a curve, that of the point of this number."""
    return f"{_VALUE}{which + 1}"


def _action(m: Maths, at: Motion, values: Values, options: Options) -> Action:
    """Over the stretch it stores the area below the curve, counted from s = 0."""
    if "parts" in values:
        return _unknown(m, at, values, options)
    curve, scale = values["curve"], values.get("scale", 1)
    if options["over"] == "rate":
        return Action(scale * m.curve(curve, at.r))
    return Action(scale * m.curve(curve, at.s), scale * m.curve(curve.area(), at.s))


def _unknown(m: Maths, at: Motion, values: Values, options: Options) -> Action:
    """A curve whose values at its points are numbers of the model: each times its part."""
    parts = [(values[value_name(i)], part) for i, part in enumerate(values["parts"])]
    if options["over"] == "rate":
        return Action(sum(value * m.curve(part, at.r) for value, part in parts))
    force, stored = 0, 0
    for value, part in parts:
        force += value * m.curve(part, at.s)
        stored += value * m.curve(part.area(), at.s)
    return Action(force, stored)


def _formula(keys: Collection[str], options: Options) -> str:
    force = f"curve({OVER[options.get('over', 'stretch')]})"
    return f"scale*{force}" if "scale" in keys else force


def _phrase(n: Numbers, options: Options) -> Phrase | None:
    """The force at some of the points of a curve that was found."""
    terms: list[str] = []
    while value_name(len(terms)) in n:
        terms.append(value_name(len(terms)))
    if len(terms) < 2:
        return None
    noun, over = ("torque" if n.turns else "force"), options.get("over", "stretch")
    x = [n.place(term)[0] for term in terms]
    bent = _bent(x, [n.value(term) for term in terms], over)
    last = len(terms) - 1
    shown = sorted({round(i * last / (_TOLD - 1)) for i in range(_TOLD)})
    said = n.listed([f"{n.amount(terms[i])} at {_where(n, terms[i])}" for i in shown])
    tail = f"by a curve through {len(terms)} points, none of the listed laws being as good: {said}"
    lost = over == "rate" and all(n.value(t) * at >= 0 for t, at in zip(terms, x, strict=True))
    return Phrase(f"a {noun} of the {over}{bent}", tail, tuple(terms), "motion" if lost else "")


def _where(n: Numbers, term: str) -> str:
    at, unit = n.place(term)
    return n.derived_small(at, unit) if unit in ("m", "rad") else n.derived(at, unit)


def _bent(x: Sequence[float], y: Sequence[float], over: str) -> str:
    """How steep a curve is where little moves against where much does, in words."""
    far = 0.5 * max(abs(x[0]), abs(x[-1]))
    inner: list[tuple[float, float]] = []
    outer: list[tuple[float, float]] = []
    for i in range(len(x) - 1):
        middle, width = 0.5 * (x[i] + x[i + 1]), x[i + 1] - x[i]
        (inner if abs(middle) < far else outer).append((width, y[i + 1] - y[i]))
    if not inner or not outer:
        return ""
    near, beyond = (abs(sum(r for _, r in p)) / sum(w for w, _ in p) for p in (inner, outer))
    small, large = ("speeds", "ones") if over == "rate" else ("stretches", "ones")
    if near > _BENT * beyond:
        return f", steep at small {small} and flatter at large {large},"
    if beyond > _BENT * near:
        return f", soft at small {small} and steeper at large {large},"
    return ""


LAW = Law(
    name="curve",
    keys=(
        Key("scale", 0, 0, 0, "1", "factor of the force", symbol="c"),
        Key(
            "over",
            0,
            0,
            0,
            None,
            "what the force is a function of, stretch or rate",
            choices=tuple(OVER),
        ),
        LENGTH,
    ),
    energy="dissipative",
    words="a characteristic curve",
    law="scale*curve(s) or scale*curve(s')",
    strengths=(),
    needs=("over",),
    action=_action,
    phrase=_phrase,
    formula=_formula,
    example={"scale": 1.5},
)
