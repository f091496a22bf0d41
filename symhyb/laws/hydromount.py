r"""A mass behind a spring, damped against rest: the fluid in the inertia track of a hydromount.

    o──▶ s       o──▶ z        F = stiffness·dead(s − z, clearance),   w = z'
    place──/\/\/──[m]──[===]──|         m w' = F − damping·w − drag·|w|·w

The stiffness is that with which the chamber bulges, m the mass of the fluid times the square of
piston area over track area, z its displacement as the piston sees it. Losses of the track are
linear, or grow with the square of the speed; within ± clearance the decoupler moves and no fluid
does. Far below its frequency it damps, far above it is the spring. Without losses it is what a mode
is beside a spring; a soft ground is one, too. The rubber is a spring and a damper beside it.

Source: Singh, Kim & Ravindra, Journal of Sound and Vibration 158, 1992 (linear model of a mount
with inertia track and decoupler).
"""

from symhyb.laws.base import Key, Law, State
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    (z, w), k, mass = at.z, values.get("stiffness", 0), values["mass"]
    pressed = at.s - z
    if "clearance" in values:
        c = values["clearance"]
        pressed = m.max(pressed - c, 0) - m.max(-pressed - c, 0)
    lost = values.get("damping", 0) * w
    if "drag" in values:
        lost += values["drag"] * m.abs(w) * w
    force = k * pressed
    stored = mass * w**2 / 2 + k * pressed**2 / 2
    return Action(force, stored, (w, (force - lost) / mass), (at.s, at.r))


def _phrase(n: Numbers, _: Options) -> Phrase | None:
    if "stiffness" not in n or "mass" not in n:
        return None
    head = f"a mass of {n.amount('mass')} behind a spring of {n.amount('stiffness')}"
    losses = [n.amount(key) for key in ("damping", "drag") if key in n]
    head += f", damped against rest by {n.listed(losses)} (inertia track)" if losses else ""
    tail = f"behind a play of {n.small('clearance')} to each side" if "clearance" in n else ""
    return Phrase(head, tail, terms=("stiffness", "mass", "damping", "drag", "clearance"))


LAW = Law(
    name="hydromount",
    keys=(
        Key("stiffness", 1, -1, 0, symbol="k_b", noun="stiffness of the chamber"),
        Key("mass", 1, -1, 2, lower=0.0, divides=True, inertia=True, symbol="m_f"),
        Key("damping", 1, -1, 1, "0", "against rest", lower=0.0, symbol="d_f"),
        Key("drag", 1, -2, 2, "0", "of the same, quadratic in speed", lower=0.0, symbol="b_f"),
        Key("clearance", 0, 1, 0, "0", "play of the decoupler to each side", lower=0.0, exact=True),
    ),
    energy="dissipative",
    words="a mass behind a spring (inertia track)",
    law="stiffness*dead(s - z, clearance)",
    strengths=("stiffness",),
    needs=("mass",),
    states=(
        State("z", "w"),
        State("w", "(F - damping*w - drag*abs(w)*w)/mass", time=-1),
    ),
    action=_action,
    stiff=True,
    steady=True,
    subject="relaxation",
    phrase=_phrase,
    example={"stiffness": 300.0, "mass": 0.5, "damping": 4.0, "drag": 2.0, "clearance": 0.01},
)
