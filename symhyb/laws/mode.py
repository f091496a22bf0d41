r"""A mode that the model does not have: a mass on a spring and a damper that rides on the place.

    o──▶ s     o──▶ u          F = m (ω² e + 2ζω (s' − w)),   e = s − u,   w = u'
    place──/\/\/──┐            e' = s' − w
         ──[===]──[m]          w' = ω² e + 2ζω (s' − w),      ω = 2π·frequency

It is a flexible link, a load on its straps, a tank that sloshes. Far below its frequency it is an
added mass; far above, the mass stands still, and a spring and a damper to the ground are left. No
acceleration of the place is asked for, and its stretch acts by its rate alone: where a place is
counted from does not matter. The weight of the mass is not part of it.

Source: Den Hartog, Mechanical Vibrations, 4th ed., 1956, §3.2.
"""

from symhyb.laws.base import Key, Law, State
from symhyb.laws.lines import NARROW
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase

PERCENT = 100.0


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    (e, w), mass, loss = at.z, values.get("mass", 0), values.get("damping_ratio", 0)
    pace = 2 * m.pi * values["frequency"]
    pull = pace**2 * e + 2 * loss * pace * (at.r - w)
    stored = mass * (w**2 + pace**2 * e**2) / 2
    return Action(mass * pull, stored, (at.r - w, pull), (0, at.r))


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "mass" not in n or "frequency" not in n:
        return None
    parts = [n.amount("frequency")]
    if "damping_ratio" in n:
        loss = n.counted(PERCENT * n.value("damping_ratio"), PERCENT * n.sd("damping_ratio"))
        parts.append(f"{loss} % damping")
    head = f"a mode of {n.listed([*parts, n.amount('mass')])}"
    return Phrase(head, terms=("mass", "frequency", "damping_ratio"))


LAW = Law(
    name="mode",
    keys=(
        Key("mass", 1, -1, 2, lower=0.0, inertia=True, symbol="m_h", noun="hidden mass"),
        Key(
            "frequency",
            0,
            0,
            -1,
            None,
            "of the mass on its spring while the place is held",
            lower=0.0,
            reach=NARROW,
            divides=True,
            exact=True,
            symbol="f_h",
            spoken=("1/s", "Hz"),
        ),
        Key("damping_ratio", 0, 0, 0, "0", "of the critical one", lower=0.0, symbol="zeta_h"),
    ),
    energy="dissipative",
    words="a mode",
    law="mass*w'",
    strengths=("mass",),
    needs=("frequency",),
    states=(
        State("e", "s' - w"),
        State("w", "W^2*e + 2*damping_ratio*W*(s' - w), W = 2*pi*frequency", time=-1),
    ),
    action=_action,
    of_state=False,
    steady=True,
    subject="added_mass",
    phrase=_phrase,
    example={"mass": 0.2, "frequency": 1.5, "damping_ratio": 0.1},
)
