"""Numbers of an actuator that explain an input as well as each other, as alternatives."""

import numpy as np

from symhyb.correction.adequacy.actuators import Behind
from symhyb.correction.search.trajectory import firsts_of
from symhyb.discrepancy.results import Alternative, Estimate
from symhyb.model.actuators import ACTUATOR_KEYS


def actuator_rivals(behind: Behind, group: int) -> tuple[Alternative, ...]:
    """Each structure as an alternative, by how much less likely it is than the first (−2 ln of the
    odds), and the sensors that may lag instead; numbers that hold together share a number from
    ``group`` on."""
    found: list[Alternative] = []
    for which, trial in enumerate(behind.trials):
        declared = {item.path: item for item in trial.machine.model.all_parameters()}
        spread = np.sqrt(np.abs(np.diag(trial.fit.covariance)))
        mine = [
            (cause, first)
            for cause, first in zip(trial.causes, firsts_of(trial.causes), strict=True)
            if cause.kind in ACTUATOR_KEYS
        ]
        evidence = 2 * (behind.trials[0].evidence - trial.evidence)
        for cause, first in mine:
            item = declared[cause.path]
            value, sd = (float(x[first]) / item.unit.factor for x in (trial.fit.values, spread))
            one = Estimate(cause.kind, value, sd, item.unit.text, cause.kind)
            together = group + which if len(mine) > 1 else 0
            found.append(
                Alternative(
                    None, cause.kind, (one,), evidence, channel=item.owner, together=together
                )
            )
    sensors = (Alternative(None, "lag", (), 0.0, channel=name) for name in behind.sensors)
    return (*found, *sensors)
