"""The noise of the sensors as the innovations measure it beside a decided structure.

A spline follows noise that is correlated in time, so that smoothing measures too little of it, and
the rest looks like a mismatch that no cause explains. The innovations know the colour of noise, but
only beside a structure that explains the motion. So where a decided structure leaves more than the
noise of smoothing they are asked how much of that is noise. Noise that is a small part of what is
left decides nothing.
"""

import numpy as np

from symhyb.correction.adequacy.beyond import beyond
from symhyb.correction.adequacy.channel_noise import sensor_sd
from symhyb.correction.adequacy.followed import followed
from symhyb.correction.adequacy.recorded import recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined
from symhyb.judgement import NEAR_NOISE, UNEXPLAINED
from symhyb.numeric.kernels.buffers import Array


def measured_again(
    prepared: Prepared, setting: Setting, selected: Refined, along: Fitted | None
) -> tuple[Array | None, Fitted | None]:
    """The noise (m,) of the sensors, SI, where a ``selected`` structure leaves more than noise and
    the innovations measure another one that explains it; None where it stands. Repeated runs show
    it already. With it the structure ``along`` whole recordings, once that is known."""
    if prepared.repeats or selected.fit.scale < NEAR_NOISE:
        return None, along
    ground = recorded(prepared, setting)
    if ground is None:
        return None, along
    along = along or followed(ground, selected, (selected, setting.stages[-1].cuts))
    if along.fit.reason:
        return None, along
    sd = sensor_sd(ground, along, beyond(ground, along))
    louder = float(np.max((sd / setting.sd) ** 2))
    loud = louder > max(NEAR_NOISE, selected.fit.scale / UNEXPLAINED)
    return sd if loud else None, along
