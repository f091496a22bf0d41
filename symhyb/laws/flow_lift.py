r"""A force that grows with the square of a speed that was recorded: lift, thrust, dynamic pressure.

        ▲ s                         Q = lift·flow²
    ═══════════  ◀~~~ flow

The flow crosses the stretch, so that the motion of the place does not change it: the lift of a wing
or a deck in the wind, or the thrust of a propeller at a recorded speed.

Source: Anderson, Fundamentals of Aerodynamics, 5th ed., 2011, §1.5 (the force is ½·rho·V²·S·C_L).
"""

from collections.abc import Iterator

from symhyb.laws.base import LENGTH, STRETCHED, Key, Law
from symhyb.laws.flow_drag import FLOW
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import LOSS, Candidate, Reach


def _action(_: Maths, __: Motion, values: Values, ___: Options) -> Action:
    return Action(values.get("lift", 0) * values["flow"] ** 2)


def _candidates(reach: Reach) -> Iterator[Candidate]:
    for name in reach.flows:
        yield Candidate(("lift",), (False,), options=(("flow", name),), order=LOSS)


def _phrase(n: Numbers, options: Options) -> Phrase | None:
    if "lift" not in n:
        return None
    noun, flow = ("torque" if n.turns else "force"), options.get("flow", "a flow")
    head = f"a {noun} of {n.amount('lift')} times the square of {flow} (lift or thrust)"
    return Phrase(head, terms=("lift",))


LAW = Law(
    name="flow_lift",
    keys=(
        Key("lift", 1, -2, 2, symbol="b_l", noun="lift coefficient"),
        FLOW,
        LENGTH,
    ),
    energy="active",
    words="lift or thrust quadratic in a flow",
    law="lift*flow^2",
    strengths=("lift",),
    placements=STRETCHED,
    needs=("flow",),
    action=_action,
    candidates=_candidates,
    of_state=False,
    at_rest=True,
    phrase=_phrase,
    pushes="lift",
    example={"lift": -0.4, "flow": 2.5},
)
