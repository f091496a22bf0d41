"""The table of kinds: what acts, on which machines, and what is right to say about it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from zlib import crc32

import kinds_drive
import kinds_force
import kinds_formula
import kinds_inner
import kinds_sensor
from bare import Bare
from numpy.random import Generator
from simulate import Change

ALL = ("mass", "hardening", "pendulum", "axis", "chain", "cart", "gimbal")
FIXED = ("mass", "hardening", "pendulum", "chain", "gimbal")  # constant inertia, or one of its own
STRAIGHT = ("mass", "hardening", "axis", "chain", "gimbal")  # an inertia that can be split
OPEN = ("mass", "hardening", "pendulum", "chain", "cart", "gimbal")
STIFF = ("mass", "hardening", "gimbal", "chain", "cart")  # an uncertain stiffness
PLANE = ("gimbal",)

Make = Callable[[Bare, Generator, Generator], Change]


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind: the ``classes`` that are right answers, the best first, and the claims of the
    vocabulary (kind of law or fault) at its place or channel that are accepted for it.

    ``make(bare, sizes, fresh)`` draws it: ``sizes`` is the same for both recordings of a case,
    ``fresh`` is not. ``absorbed``: whether a draw must be more than the model's own parameters,
    faults of channels and simple laws can absorb (see visible.py).
    """

    name: str
    classes: tuple[str, ...]
    machines: tuple[str, ...]
    make: Make
    accepted: tuple[str, ...] = ()
    absorbed: bool = True

    @property
    def number(self) -> int:
        """A number of the kind that does not depend on the rest of the table."""
        return crc32(self.name.encode())


d, f, i, s = kinds_drive, kinds_force, kinds_inner, kinds_sensor
TABLE = (
    # what actuators do has a name by now: the right one is right too, with the right number
    Kind("dead band", ("input",), ALL, d.dead_band, ("dead_band",)),
    Kind("saturation", ("input",), ALL, d.saturation, ("limit",)),
    Kind("soft saturation", ("input",), ALL, d.soft_saturation),
    Kind("uneven input", ("input",), ALL, d.uneven),
    Kind("slew rate", ("input", "lag"), ALL, d.slew, ("rate_limit", "lag")),
    Kind("held input", ("input",), ALL, d.held, ("held",), absorbed=False),
    Kind("noisy input", ("input",), OPEN, d.noisy),
    Kind("cross-talk", ("input", "coupling"), PLANE, d.cross_talk),
    Kind("fading input", ("time-varying", "input"), ALL, d.fading),
    Kind("actuator lag", ("lag",), ALL, d.lag, ("lag",)),
    Kind("resonant actuator", ("lag", "hidden mode", "input"), ALL, d.resonant),
    Kind("hidden load", ("hidden mode",), STRAIGHT, i.load, ("mode",)),
    Kind("flexible link", ("hidden mode",), STRAIGHT, i.link),
    Kind("loose load", ("hidden mode",), STRAIGHT, i.loose),
    Kind("soft ground", ("hidden mode",), ("mass",), i.ground, ("mode",)),
    Kind("pulsating", ("time-varying",), STIFF, i.pulsating),
    Kind("drifting", ("time-varying",), ALL, i.drifting),
    Kind("stepping", ("time-varying",), STIFF, i.stepping),
    Kind("gyroscopic", ("coupling",), PLANE, i.gyroscopic, ("gyroscopic",)),
    Kind("circulatory", ("coupling",), PLANE, i.circulatory, ("circulatory",)),
    Kind("skew spring", ("coupling",), PLANE, i.skew, ("skew_spring",)),
    # listed laws by now: the right one at its place is right, and so is the class
    Kind("digressive damper", ("law",), ALL, f.digressive, ("damper_kinked",)),
    Kind("eddy brake", ("law",), ALL, f.eddy, ("eddy_brake",)),
    Kind("power 1.5", ("law",), ALL, f.power, ("power",)),
    Kind("friction by place", ("law",), ALL, f.guide, ("friction",)),
    Kind("magnet", ("law",), FIXED, f.magnet),
    Kind("saturating spring", ("law",), OPEN, f.saturating),
    Kind("exponential spring", ("law",), OPEN, f.exponential),
    Kind("Hertz contact", ("law",), OPEN, f.hertz, ("gap",)),
    Kind("detent", ("law",), OPEN, f.detent),
    Kind("brake zone", ("law",), ALL, f.brake_zone),
    Kind("pinch", ("law",), ALL, f.pinch),
    Kind("formula", ("law",), ALL, kinds_formula.formula, ("power",)),
    Kind("disturbance", ("unmeasured force",), ALL, f.disturbance),
    Kind("rumble", ("unmeasured force",), ALL, f.rumble),
    Kind("knocks", ("unmeasured force",), ALL, f.knocks),
    Kind("gust", ("unmeasured force", "time-varying"), ALL, f.gust),
    Kind("moving ground", ("unmeasured force",), ("mass", "hardening"), f.moving_ground),
    Kind("sensor drift", ("sensor",), ALL, s.drift),
    Kind("sensor clips", ("sensor",), ALL, s.clips),
    Kind("curved sensor", ("sensor",), ALL, s.curved),
    Kind("gain drifts", ("sensor", "time-varying"), ALL, s.gain_drifts),
    Kind("sensor lag", ("lag", "sensor"), ALL, s.lag, ("sensor_lag",)),
    Kind("sensor freezes", ("sensor",), ALL, s.freezes),
    Kind("noise coloured", ("noise",), ALL, s.coloured),
    Kind("noise growing", ("noise",), ALL, s.growing),
    Kind("noise quantised", ("noise",), ALL, s.quantised),
    Kind("noise heavy", ("noise",), ALL, s.heavy),
    Kind("law, coloured", ("law",), OPEN, s.law_coloured, absorbed=False),
    Kind("law, growing", ("law",), OPEN, s.law_growing, absorbed=False),
    Kind("law, quantised", ("law",), OPEN, s.law_quantised, absorbed=False),
    Kind("law, heavy", ("law",), OPEN, s.law_heavy, absorbed=False),
)
KINDS: Mapping[str, Kind] = MappingProxyType({kind.name: kind for kind in TABLE})
