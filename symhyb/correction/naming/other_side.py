"""Late sensors or late inputs: where all of one side are late by the same, all of the other may be.

A machine whose laws do not depend on the time answers inputs that act later with the same motion,
later. So no recording determines on which side of the machine the delay is.
"""

from collections.abc import Sequence

from symhyb.discrepancy.results import Alternative, Estimate, Measurement
from symhyb.judgement import OUTSTANDING
from symhyb.model.delays import runs_by_clock
from symhyb.model.types import Model


def late_on_the_other_side(
    model: Model,
    faults: Sequence[Measurement],
    group: int,
    told: Sequence[Alternative] = (),
) -> tuple[Alternative, ...]:
    """The delays of all inputs in place of those of all sensors among the ``faults``, or the other
    way around, which hold together (``group`` is their number); none where they differ, or where
    that is ``told`` already. One sensor and one input are a pair that the search itself
    compares."""
    late = {fault.channel: fault for fault in faults if fault.kind == "delay"}
    if not late or any(c.imposed for c in model.coordinates) or runs_by_clock(model):
        return ()
    sides = [[item.name for item in side] for side in (model.sensors, model.recorded_inputs)]
    for mine, others in (sides, sides[::-1]):
        if late.keys() == {*mine} and len(mine) * len(others) > 1:
            first = min(late.values(), key=lambda fault: fault.sd)
            if any(abs(one.value - first.value) > OUTSTANDING * one.sd for one in late.values()):
                return ()
            if {*others} <= {one.channel for one in told if one.kind == "delay"}:
                return ()
            delay = Estimate("delay", first.value, first.sd, first.unit, "delay")
            instead_of, together = f"{mine[0]}.delay", group if len(others) > 1 else 0
            return tuple(
                Alternative(instead_of, "delay", (delay,), 0.0, channel=name, together=together)
                for name in others
            )
    return ()
