"""Reference of the kinds of elements, from the laws: formula, sign, keys and a drawing."""

from collections.abc import Iterator
from math import inf

from _site.shown import shown
from symhyb.laws import LAWS
from symhyb.laws.base import Key, Law, Placement, nothing_tried
from symhyb.model.types import Coordinate, Model, On
from symhyb.model.vocabulary import key_unit
from symhyb.units import parse_unit

ON_LENGTH, ON_ANGLE = On("x"), On("phi")
RIG = Model("", (Coordinate("x", parse_unit("m")), Coordinate("phi", parse_unit("rad"))))
ENERGY = {
    "conservative": "stores energy and gives it back",
    "dissipative": "takes energy out of the motion",
    "active": "may feed energy in",
}
IN_PLACE_OF = {
    "curve": "a force of stretch and rate without a name",
    "mode": "a hidden mode",
    "gyroscopic": "a coupling",
    "circulatory": "a coupling",
    "skew_spring": "a coupling",
    "skew_damper": "a coupling",
    "hydromount": "a hidden mode",
}
OWN_ENERGY = {
    "curve": "stores energy over the stretch, and takes it out, or feeds it in, over the rate",
    "gyroscopic": "does no work",
    "circulatory": "feeds energy into a motion that turns its way, and takes it out of others",
    "skew_damper": "takes energy out of the motion beside dampers of at least its size on both",
    "map": "stores no energy; takes it out, or feeds it in, as the table says",
}
PAIR = """\
pair: F = (F_a, F_b) pushes along each of the two stretches

      ^ b
      │ ▲ F_b
      │ └──▶ F_a
      └────────▶ a"""
SKETCHES: dict[tuple[bool, Placement], str] = {
    (True, "on"): """\
on: F > 0 pulls back, Q = −F on the coordinate

    wall ┤──[ F ]──[m]──▶ s
                F ◀──┘""",
    (False, "on"): """\
on: F > 0 pushes along, Q = +F on the coordinate

    [m]──▶ s
     └──▶ F""",
    (True, "between"): """\
between: F > 0 is a tension, which pulls the points together

    a o──▶ F          F ◀──o b
      │◀── length + s ───▶│""",
    (True, "at"): """\
at: against the velocity v of the point, s′ = |v|

    F ◀──o──▶ v""",
    (False, "at"): """\
at: the vector itself, at the point

    o──▶ F""",
}
SKETCHES[False, "between"] = SKETCHES[True, "between"]
SKETCHES |= {(True, "pair"): PAIR, (False, "pair"): PAIR}


def kinds_text() -> str:
    """All kinds as MyST."""
    return "\n\n".join("\n\n".join(section(law)) for law in LAWS)


def section(law: Law) -> Iterator[str]:
    """One kind, paragraph by paragraph."""
    yield f"## `{law.name}`"
    places = " · ".join(f"`{one}`" for one in law.placements)
    words, energy = law.words[0].upper() + law.words[1:], ENERGY[law.energy]
    yield f"{words}; {OWN_ENERGY.get(law.name, energy)}. Places: {places}."
    yield "\n".join(["```text", f"F = {law.law}", *(state.text for state in law.states), "```"])
    sketches = "\n\n".join(sketch(law, place) for place in law.placements)
    yield f"```text\n{sketches}\n```"
    if law.keys:
        yield keys_table(law)
    yield from notes(law)
    drawing = shown(law)
    if drawing is not None:
        yield f"```{{raw}} html\n{drawing.svg}\n```"
        yield f"*F over {drawing.over}, with {', '.join(told(law, drawing.values))}.*"


def sketch(law: Law, place: Placement) -> str:
    """Which way F acts at a kind of place."""
    if law.inertial and place == "at":
        return "at: against the acceleration a of the point\n\n    F ◀──o──▶ a"
    return SKETCHES[law.passive, place]


def keys_table(law: Law) -> str:
    """The keys of a kind with units on a length and on an angle, unset values and bounds."""
    lines = ["| key | unit | on an angle | unset | bounds | |", "|---|---|---|---|---|---|"]
    for key in law.keys:
        cells = (f"`{key.name}`", *units(law, key), unset(law, key), bounds(key), remark(law, key))
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def units(law: Law, key: Key) -> tuple[str, str]:
    """The unit of a key on a length and on an angle."""
    if key.choices:
        return "a word", "a word"
    if key.spoken[1]:
        return key.spoken[1], key.spoken[1]
    if key.name == "torque":
        return "N\\*m", "N\\*m"
    if key.placements == ("between",):
        return unit_text(law, key, ON_LENGTH), ""
    return unit_text(law, key, ON_LENGTH), unit_text(law, key, ON_ANGLE)


def unit_text(law: Law, key: Key, place: On) -> str:
    """One unit; of a key whose unit hangs on an exponent n, that with n."""
    text = key_unit(RIG, law.name, key.name, place).text
    if key.exponent:
        return f"{text}^n".replace("1^n", "1")
    return text.replace("*", "\\*")


def unset(law: Law, key: Key) -> str:
    """What a key is that the file does not state."""
    if key.name in law.needs or (key.name in law.strengths and len(law.strengths) == 1):
        return "required"
    if key.signal:
        return "one of them"
    if key.default is None:
        return ""
    return f"`{key.default}`" if key.default.isidentifier() else key.default


def bounds(key: Key) -> str:
    """Between which values a diagnosis looks, and what no file may state."""
    low, high = key.lower, key.upper
    parts = []
    if key.choices:
        return " · ".join(f'`"{word}"`' for word in key.choices)
    if low == 0 and key.divides:
        return "> 0"
    if low > -inf and high < inf:
        parts.append(f"{low:g} … {high:g}")
    elif low > -inf:
        parts.append(f"≥ {low:g}")
    elif high < inf:
        parts.append(f"≤ {high:g}")
    if key.divides:
        parts.append("not 0")
    return ", ".join(parts)


def remark(law: Law, key: Key) -> str:
    """What else is to be known of a key."""
    parts = [key.about] if key.about and not key.about.startswith("rad;") else []
    if key.vector and "at" in law.placements and "a list" not in key.about:
        parts.append("at a point a list")
    if key.placements not in (law.placements, ("on", "between", "at")):
        parts.append(" and ".join(f"`{place}`" for place in key.placements) + " only")
    return "; ".join(dict.fromkeys(parts)).replace("*", "\\*")


def notes(law: Law) -> Iterator[str]:
    """How the kind is searched, and how it is simulated."""
    found = law.candidates is not nothing_tried
    parts = ["A diagnosis looks for it." if found else "A diagnosis does not look for it."]
    if law.name in IN_PLACE_OF:
        parts = [f"A diagnosis finds it in place of {IN_PLACE_OF[law.name]} that is certain."]
    if len(law.strengths) > 1 and not set(law.strengths) & set(law.needs):
        needed = ", ".join(f"`{name}`" for name in law.strengths)
        one = law.key(law.strengths[0])
        count = "Exactly" if one and one.signal else "At least"
        parts.insert(0, f"{count} one of {needed} is needed.")
    if law.states:
        names = " and ".join(state.name for state in law.states)
        alone = len(law.states) == 1
        said = f"inner state {names} belongs" if alone else f"inner states {names} belong"
        parts.append(f"Its {said} to the state of the machine.")
    if law.switch == "holds":
        parts.append("In an exact simulation it holds still.")
    if law.switch == "touches":
        parts.append("In an exact simulation it touches and leaves at located times.")
    yield " ".join(parts)


def told(law: Law, values: dict[str, float]) -> Iterator[str]:
    """Values of keys with their units on a length."""
    for name, value in values.items():
        key = law.key(name)
        if key is None:
            continue
        unit = units(law, key)[0]
        yield f"{name} = {value:g}" + (f" {unit}" if unit != "1" else "")
