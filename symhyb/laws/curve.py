"""A characteristic curve: a memoryless force over the stretch or over its rate, given by points.

A curve c over the stretch may be a factor of the speed: damping c·s′, or drag c·|s′|s′, that
changes with the stretch. One over the rate may be multiplied by a curve over the stretch: a loss of
which more acts at one place than at another.
"""

from collections.abc import Collection, Sequence

from symhyb.laws.base import LENGTH, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Value, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.limits import CURVE_POINTS

OVER = {"stretch": "s", "rate": "s'"}
TIMES = {"rate": "s'", "square": "abs(s')*s'"}
SPEED_POWERS = {"": 0, "rate": 1, "square": 2}  # in what a curve is a factor of
SYMBOLS = {"": "F", "rate": "d", "square": "b"}  # of the values of a curve
NOUNS = {"rate": "damping", "square": "drag"}
_VALUE = "f"  # of the names of unknown values
_FACTOR = "w"
_TOLD = 5  # points whose values a sentence tells
_DIGITS = 3  # of where they are
_BENT = 2.0  # times: the mean slope of the outer half over that of the inner half, or the reverse


def value_name(which: int) -> str:
    """The name of an unknown value of a curve, that of the point of this number."""
    return f"{_VALUE}{which + 1}"


def factor_name(which: int) -> str:
    """The name of the unknown change of what a curve is multiplied by, at the point of this
    number."""
    return f"{_FACTOR}{which + 1}"


def speed_factor(m: Maths, rate: Value, options: Options) -> Value:
    """What the curve is multiplied by: 1, or a function of the rate."""
    match options.get("times", ""):
        case "rate":
            return rate
        case "square":
            return m.abs(rate) * rate
        case _:
            return 1


def _action(m: Maths, at: Motion, values: Values, options: Options) -> Action:
    """Over the stretch alone it stores the area below the curve, counted from s = 0."""
    if "parts" in values:
        parts = [(values[key], curve, factor) for key, curve, factor in values["parts"]]
    else:
        parts = [(values.get("scale", 1), values["curve"], values.get("by_stretch"))]
    over_rate, factor = options["over"] == "rate", speed_factor(m, at.r, options)
    force, stored = 0, 0
    for value, curve, by_stretch in parts:
        share = value if by_stretch is None else value * m.curve(by_stretch, at.s)
        force += share * m.curve(curve, at.r if over_rate else at.s)
        stored += 0 if over_rate or "times" in options else value * m.curve(curve.area(), at.s)
    return Action(force * factor, stored)


def _formula(keys: Collection[str], options: Options) -> str:
    force = f"curve({OVER[options.get('over', 'stretch')]})"
    if "by_stretch" in keys:
        force = f"by_stretch(s)*{force}"
    if options.get("times"):
        force += f"*{TIMES[options['times']]}"
    return f"scale*{force}" if "scale" in keys else force


def _phrase(n: Numbers, options: Options) -> Phrase | None:
    """The force at some of the points of a curve that was found."""
    terms = [key for key in map(value_name, range(CURVE_POINTS)) if key in n]
    factors = [key for key in map(factor_name, range(CURVE_POINTS)) if key in n]
    if len(terms) < 2:
        return None
    over, times = options.get("over", "stretch"), options.get("times", "")
    noun = NOUNS.get(times) or ("torque" if n.turns else "force")
    x = [n.place(term)[0] for term in terms]
    bent = _bent(x, [n.value(term) for term in terms], over)
    way = "along" if times else "by"
    tail = (
        f"{way} a curve through {len(terms)} points, no law by name being clearly better: "
        f"{_values(n, terms)}"
    )
    if factors:
        tail += (
            f"; multiplied by a curve over the stretch through {len(factors) + 1} points, 1 at "
            f"the one known best: {_values(n, factors)}"
        )
        head = f"a {noun} of the rate that changes with the stretch"
        pairs = zip(terms, x, strict=True)
        lost = all(n.value(term) * at >= 0 for term, at in pairs)
        lost = lost and all(n.value(term) >= 0 for term in factors)
        return Phrase(head, tail, (*terms, *factors), "motion" if lost else "")
    if times:
        lost = all(n.value(term) >= 0 for term in terms)
        head = f"{noun} that changes with the {over}"
    else:
        pairs = zip(terms, x, strict=True)
        lost = over == "rate" and all(n.value(term) * at >= 0 for term, at in pairs)
        head = f"a {noun} of the {over}{bent}"
    return Phrase(head, tail, tuple(terms), "motion" if lost else "")


def _values(n: Numbers, terms: Sequence[str]) -> str:
    """The values at some of the points."""
    shown = _shown([n.value(term) for term in terms])
    return n.listed([f"{n.amount(terms[i])} at {_where(n, terms[i])}" for i in shown])


def _shown(y: Sequence[float]) -> list[int]:
    """The points that a sentence holds: both ends, and of the others evenly many with the largest
    value among them."""
    last = len(y) - 1
    shown = [round(i * last / (_TOLD - 1)) for i in range(_TOLD)]
    most = max(range(len(y)), key=lambda i: abs(y[i]))
    if most not in shown:
        nearest = min(range(1, _TOLD - 1), key=lambda i: abs(shown[i] - most))
        shown[nearest] = most
    return sorted(set(shown))


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
        Key(
            "times",
            0,
            0,
            0,
            None,
            "what a curve over the stretch is a factor of: rate s', or square abs(s')*s'",
            choices=tuple(TIMES),
        ),
        LENGTH,
    ),
    energy="dissipative",
    words="a characteristic curve",
    law="scale*curve(s) or scale*curve(s'), or scale*curve(s) times s' or abs(s')*s'",
    strengths=(),
    needs=("over",),
    action=_action,
    phrase=_phrase,
    formula=_formula,
    example={"scale": 1.5},
)
