"""What an actuator does to a recorded input before it acts, in this order.

    recorded → delay → quantum → dead band → backlash → limit → lag, of limited rate
             → gain, offset → acting

The names of the keys under ``[inputs]`` of a model file, their units and what is refused.
"""

from collections.abc import Mapping
from typing import Literal

from symhyb.units import ONE, Unit, parse_unit

ActuatorKey = Literal["quantum", "dead_band", "backlash", "limit", "rate_limit", "lag"]
ACTUATOR_KEYS: tuple[ActuatorKey, ...] = (  # in the order in which they act
    "quantum",
    "dead_band",
    "backlash",
    "limit",
    "rate_limit",
    "lag",
)
MAY_BE_ZERO: tuple[ActuatorKey, ...] = ("quantum", "dead_band", "backlash", "lag")  # as if unset

FaultKey = Literal["gain", "offset", "delay"]
FAULT_KEYS: tuple[FaultKey, ...] = ("gain", "offset", "delay")  # of inputs and of sensors

SENSOR_LAG: Literal["sensor_lag"] = "sensor_lag"  # the time constant of a sensor that lags

# an input that is held has no number
ChannelKind = Literal[FaultKey, ActuatorKey, "held", "sensor_lag"]
CHANNEL_KINDS: Mapping[str, ChannelKind] = {  # those with a number
    key: key for key in (*FAULT_KEYS, *ACTUATOR_KEYS, SENSOR_LAG)
}


def usual_unit(key: str, channel: Unit) -> Unit:
    """The unit in which a number of a channel is read unless it states one; ``channel`` is the unit
    of what is recorded."""
    if key == "gain":
        return ONE
    if key in ("delay", "lag"):
        return parse_unit("s")
    return channel / parse_unit("s") if key == "rate_limit" else channel


def refused(key: str, value: float) -> str:
    """Why a number of a channel cannot be; empty if it can."""
    if key == "gain" and value == 0:
        return "must not be 0: such a channel says nothing"
    if key in MAY_BE_ZERO and value < 0:
        return "must not be negative"
    if key in ACTUATOR_KEYS and key not in MAY_BE_ZERO and value <= 0:
        return "must be positive: such an actuator does nothing"
    return ""
