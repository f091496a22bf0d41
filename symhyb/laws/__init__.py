"""The laws of force, one file each: the closed vocabulary of models and of what may be missing.

A new law is a new file and one name more in ``LAWS``; docs/add-a-law.md shows how.
"""

from symhyb.laws import (
    added_mass,
    circulatory,
    constant,
    curve,
    damper,
    damper_kinked,
    drag,
    eddy_brake,
    friction,
    friction_dynamic,
    gap,
    given,
    gyroscopic,
    harmonic,
    hydromount,
    hysteresis,
    map,
    mode,
    payload,
    power,
    relaxation,
    ripple,
    skew_damper,
    skew_spring,
    spring,
)
from symhyb.laws.base import Law

LAWS: tuple[Law, ...] = (
    spring.LAW,
    damper.LAW,
    drag.LAW,
    friction.LAW,
    power.LAW,
    damper_kinked.LAW,
    eddy_brake.LAW,
    gap.LAW,
    hysteresis.LAW,
    friction_dynamic.LAW,
    relaxation.LAW,
    constant.LAW,
    harmonic.LAW,
    ripple.LAW,
    added_mass.LAW,
    payload.LAW,
    mode.LAW,
    hydromount.LAW,
    curve.LAW,
    gyroscopic.LAW,
    circulatory.LAW,
    skew_spring.LAW,
    skew_damper.LAW,
    map.LAW,
    given.FORCE,
    given.TORQUE,
    given.EXPRESSION,
    given.NETWORK,
)

__all__ = ["LAWS"]
