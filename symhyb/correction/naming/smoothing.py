"""What the smoothed sign of a friction law leaves open of its breakaway level and Stribeck speed.

The law that is fitted rises over a transition instead of jumping:

    g(s') tanh(s'/transition),   g = coulomb + (static − coulomb) exp(−(s'/stribeck)²)

so its peak stays below ``static``, where dry friction reaches it. A fit makes up for that by a
higher level and a shorter Stribeck speed. Both are known no better than the smoothing allows.
"""

from collections.abc import Mapping

import numpy as np

Values = dict[str, tuple[float, float]]

SPEEDS = np.linspace(0.01, 20.0, 4000)  # in transitions, where the peak is looked for


def with_smoothing(values: Mapping[str, tuple[float, float]]) -> Values:
    """Values and deviations of a friction law by key, SI, with the deviations of ``static`` and
    ``stribeck`` widened by what the peak lacks and by the transition."""
    told = dict(values)
    if not {"coulomb", "static", "stribeck", "transition"} <= told.keys():
        return told
    coulomb, static, stribeck, transition = (
        told[key][0] for key in ("coulomb", "static", "stribeck", "transition")
    )
    speed = SPEEDS * transition
    level = coulomb + (static - coulomb) * np.exp(-((speed / stribeck) ** 2))
    lacking = max(static - float(np.max(level * np.tanh(SPEEDS))), 0.0)
    for key, bias in (("static", lacking), ("stribeck", transition)):
        value, sd = told[key]
        told[key] = value, float(np.hypot(sd, bias))  # of a number that is held, NaN stays
    return told
