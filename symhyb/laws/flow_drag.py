r"""Drag in a medium that moves: quadratic in the speed of the medium relative to the place.

    wind ⇒   ~~~▶ flow     o──▶ s        Q = drag·|flow − s'|·(flow − s')

The flow is counted along the stretch, as the stretch is. At rest it pushes the place along, and
where nothing flows it is the ``drag`` of a place that moves.

Source: Morison, O'Brien, Johnson & Schaaf, Petroleum Transactions AIME 189, 1950, with the relative
speed; of wind: Simiu & Scanlan, Wind Effects on Structures, 3rd ed., 1996, §6.
"""

from collections.abc import Iterator

from symhyb.laws.base import LENGTH, STRETCHED, Key, Law
from symhyb.laws.maths import Action, Maths, Motion, Options, Values
from symhyb.laws.phrases import Numbers, Phrase
from symhyb.laws.reach import LOSS, Candidate, Reach

WORDS, TORQUE_WORDS = "drag", "drag torque"
FLOW = Key(
    "flow",
    0,
    1,
    -1,
    None,
    "the speed of the medium along the stretch: any expression in inputs, positions, speeds, time",
    STRETCHED,
    signal=True,
)


def _action(m: Maths, at: Motion, values: Values, _: Options) -> Action:
    ahead = values["flow"] - at.r
    return Action(values.get("drag", 0) * m.abs(ahead) * ahead)


def _candidates(reach: Reach) -> Iterator[Candidate]:
    """Of each channel that shows a speed, counted along the stretch or against it."""
    for name in reach.flows:
        for flow in (name, f"-{name}"):
            yield Candidate(("drag",), (True,), options=(("flow", flow),), order=LOSS)


def _phrase(n: Numbers, options: Options) -> Phrase | None:
    if "drag" not in n:
        return None
    noun, flow = (TORQUE_WORDS if n.turns else WORDS), options.get("flow", "a flow")
    head = f"{noun} in the flow {flow}, quadratic in the relative speed ({n.amount('drag')})"
    return Phrase(head, terms=("drag",), resists=f"motion relative to {flow}")


LAW = Law(
    name="flow_drag",
    keys=(
        Key("drag", 1, -2, 2, lower=0.0, symbol="b_f", noun="drag coefficient"),
        FLOW,
        LENGTH,
    ),
    energy="active",
    words=f"{WORDS} in a flow",
    torque_words=f"{TORQUE_WORDS} in a flow",
    law="drag*abs(flow - s')*(flow - s')",
    strengths=("drag",),
    placements=STRETCHED,
    needs=("flow",),
    action=_action,
    candidates=_candidates,
    of_state=False,
    phrase=_phrase,
    resists="drag",
    example={"drag": 0.7, "flow": 2.5},
)
