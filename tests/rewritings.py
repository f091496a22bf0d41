r"""One machine written in many ways, with a recording that fits all of them: what must not change
an answer.

    wall |--/\/\/--[ 1 ]--/\/\/--[ 2 ]        chain: two masses, or two inertias on shafts
            k1, d1  └▶ x   k2, d2  └▶ y

    body z, wheel w, road h (imposed)         quarter car, heights counted upwards

A logical place (``link``: between the two; ``far``: mass 2 against the ground) is written by each
way in its own terms, so that a law can be concealed there, or added, in all of them.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from builders import Entries, model_of
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.model.expression import parse_expression
from symhyb.model.types import Between, Element, Model, On, Parameter, Place
from symhyb.model.vocabulary import key_unit
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Writing:
    """One way to write a machine. ``turn`` (n, n): ``turn`` times its coordinates are those of the
    first way, SI. ``places`` are the logical places in its own terms, ``lengths`` the distances (m)
    of those between points at which they are not stretched."""

    name: str
    model: Model
    turn: Array
    places: Mapping[str, Place]
    lengths: Mapping[str, float]

    def motion(self, q: Array) -> Array:
        """Coordinates (…, n) of the first way in those of this one, SI; rates likewise."""
        return q @ np.linalg.inv(self.turn).T

    def forces(self, force: Array) -> Array:
        """Generalized forces (…, n) of the first way as this one has them, SI: Q' = Tᵀ Q."""
        return force @ self.turn

    def with_law(
        self, kind: str, where: str, name: str = "extra", side: str = "", **values: float
    ) -> "Writing":
        """The same with one more element at a logical place, ``values`` by key in SI."""
        place, keys = self.places[where], dict(values)
        if isinstance(place, Between) and kind in ("spring", "gap"):
            keys["length"] = self.lengths[where]
        own = []
        for key, value in keys.items():
            unit = key_unit(self.model, kind, key, place)
            own.append(Parameter(key, value / unit.factor, unit, owner=name))
        entries = tuple((item.name, parse_expression(item.name)) for item in own)
        options = (("side", side),) if side else ()
        element = Element(name, kind, place, entries, tuple(own), options=options)
        return replace(self, model=replace(self.model, elements=(*self.model.elements, element)))

    def simulated(
        self, t: Array, q: Sequence[float], v: Sequence[float], u: Array, given: Array | None = None
    ) -> Trajectory:
        """A run from ``q``, ``v`` (n,) of the first way under inputs ``u`` (N, k) at ``t`` (N,),
        SI; ``given`` (N, 3·g) is the motion of imposed coordinates."""
        start = (self.motion(np.array(x, float)) for x in (q, v))
        return simulate(build(self.model), Scenario(t, *start, t, u, given=given))

    def recorded(
        self, run: Trajectory, inputs: Mapping[str, Array], noise: float = 0.0, seed: int = 0
    ) -> Recording:
        """What the sensors record of a run; ``noise`` is relative to the spread of each. As it is
        in SI it fits every way to write the machine."""
        random = np.random.default_rng(seed)
        sensors = {
            sensor.name: y + noise * y.std() * random.standard_normal(y.size)
            for sensor, y in zip(self.model.sensors, run.y.T, strict=True)
        }
        return Recording("written.csv", run.t, inputs, sensors, (), "")


def multisine(t: Array, size: float, seed: int = 0, low: float = 0.3, high: float = 5.0) -> Array:
    """A force (N,) of 14 lines between two frequencies in Hz."""
    random = np.random.default_rng(seed)
    lines, phases = np.linspace(low, high, 14), random.uniform(0, 2 * np.pi, 14)
    return size * np.sqrt(2 / 14) * np.sin(2 * np.pi * np.outer(t, lines) + phases).sum(axis=1)


def chains(turning: bool = False) -> tuple[Writing, ...]:
    """All ways to write the chain; the first by the places x, y of both masses and their
    difference. ``turning``: inertias and angles."""
    short = "deg" if turning else "mm"
    long = "rad" if turning else "m"
    ways = [
        _chain("difference", ("x", "y"), (["x"], ["y"]), turning, long),
        _chain("energy and laws", ("x", "y"), (["x"], ["y"]), turning, long, link="written"),
        _chain("travel", ("x", "s"), (["x"], ["x", "s"]), turning, long),
        _chain("other order", ("y", "x"), (["x"], ["y"]), turning, long),
        _chain("other units", ("x", "y"), (["x"], ["y"]), turning, short),
        _chain("travel in other units", ("x", "s"), (["x"], ["x", "s"]), turning, short),
    ]
    if not turning:
        ways.append(_chain("points", ("x", "y"), (["x"], ["y"]), turning, long, link="points"))
    return tuple(ways)


_UNITS = {  # by whether it turns
    False: {"m": "kg", "k": "N/m", "k3": "N/m^3", "d": "N*s/m", "f": "N"},
    True: {"m": "kg*m^2", "k": "N*m/rad", "k3": "N*m/rad^3", "d": "N*m*s/rad", "f": "N*m"},
}


def _chain(
    name: str,
    coordinates: tuple[str, ...],
    masses: tuple[list[str], list[str]],
    turning: bool,
    unit: str,
    link: str = "on",
) -> Writing:
    """A chain; ``masses`` are the coordinates that add up to the place of each."""
    x, y = (" + ".join(part) for part in masses)
    travel = "s" if "s" in coordinates else "y - x"
    places: dict[str, Place] = {"wall": On(x), "far": On(y), "link": On(travel)}
    if link == "points":
        places["link"] = Between("first", "second")
    units, push = _UNITS[turning], {False: "force", True: "torque"}[turning]
    laws = _written(push) if link == "written" else _linked(places["link"])
    model = model_of(
        coordinates={c: {"unit": unit} for c in coordinates},
        parameters={
            "m1": (1.3, units["m"]),
            "m2": (0.9, units["m"]),
            "k1": (200.0, units["k"]),
            "k2": (320.0, units["k"], 20.0),
            "k3": (4e4, units["k3"]),
            "d1": (0.8, units["d"]),
            "d2": (0.6, units["d"]),
            "d3": (0.5, units["d"]),
            "l": (0.5, "m"),
            "solid": (1.0, "kg"),
        },
        inputs={"f": {"unit": units["f"]}},
        **({} if turning else {"points": {"first": [x, "0"], "second": [f"l + {y}", "0"]}}),
        bodies=_bodies(x, y, turning),
        elements={
            "wall": {"kind": "spring", "on": x, "stiffness": "k1"},
            "bearing": {"kind": "damper", "on": x, "damping": "d1"},
            "rail": {"kind": "damper", "on": y, "damping": "d3"},
            "shaker": {"kind": push, "on": x, push: "f"},
            **laws.get("elements", {}),
        },
        **({"energy": laws["energy"]} if "energy" in laws else {}),
        sensors={
            "one": {"measures": x, "unit": unit},
            "two": {"measures": y, "unit": unit},
            "accel": {"measures": _primed(masses[1]), "unit": f"{unit}/s^2"},
        },
    )
    turn = [[float(c in part) for c in coordinates] for part in masses]
    return Writing(name, model, np.array(turn), places, {"link": 0.5})


def _bodies(x: str, y: str, turning: bool) -> Entries:
    if not turning:
        return {"one": {"mass": "m1", "at": [x, "0"]}, "two": {"mass": "m2", "at": [y, "0"]}}
    still = {"mass": "solid", "at": ["0", "0"]}
    return {
        "one": {**still, "inertia": "m1", "angle": x},
        "two": {**still, "inertia": "m2", "angle": y},
    }


def _linked(place: Place) -> dict[str, Entries]:
    """The link as elements at a place."""
    spring = {"kind": "spring", "stiffness": "k2", "cubic": "k3"}
    if isinstance(place, Between):
        at: Entries = {"between": [place.first, place.second]}
        return {
            "elements": {
                "link": {**spring, **at, "length": "l"},
                "loss": {"kind": "damper", **at, "damping": "d2"},
            }
        }
    assert isinstance(place, On)
    loss = {"kind": "damper", "on": place.coordinate, "damping": "d2"}
    return {"elements": {"link": {**spring, "on": place.coordinate}, "loss": loss}}


def _written(push: str) -> dict[str, Entries]:
    """The link as a potential energy, and as laws on both coordinates."""
    return {
        "energy": {"potential": "k2/2*(y - x)**2 + k3/4*(y - x)**4"},
        "elements": {
            "loss_x": {"kind": "law", "on": "x", push: "d2*(y' - x')"},
            "loss_y": {"kind": "law", "on": "y", push: "-d2*(y' - x')"},
        },
    }


def _primed(part: Iterable[str]) -> str:
    return " + ".join(f"{name}''" for name in part)


def quarter_cars() -> tuple[Writing, ...]:
    """All ways to write a quarter of a car on an imposed road: the first by heights and points."""
    heights = ("z", "w", "h")
    absolute = (["z"], ["w"], ["h"])
    return (
        _quarter("points", heights, absolute, "m", points=True),
        _quarter("differences", heights, absolute, "m"),
        _quarter("travel", ("s", "w", "h"), (["w", "s"], ["w"], ["h"]), "m"),
        _quarter("other units", heights, absolute, "mm"),
    )


def _quarter(
    name: str,
    coordinates: tuple[str, ...],
    heights: tuple[list[str], list[str], list[str]],
    unit: str,
    points: bool = False,
) -> Writing:
    """A quarter car; ``heights`` are the coordinates that add up to body, hub and road."""
    z, w, h = (" + ".join(part) for part in heights)
    travel = "s" if "s" in coordinates else f"{z} - {w}"
    strut, tyre = f"{travel} - l_s", f"{w} - {h} - r"
    places: dict[str, Place] = {"strut": On(strut), "tyre": On(tyre), "body": On(z)}
    if points:
        places |= {"strut": Between("hub", "top"), "tyre": Between("contact", "hub")}

    def at(where: str, length: str = "") -> Entries:
        if points:
            ends = {"strut": ["hub", "top"], "tyre": ["contact", "hub"]}[where]
            return {"between": ends, **({"length": length} if length else {})}
        return {"on": strut if where == "strut" else tyre}

    model = model_of(
        gravity=["0", "-g"],
        coordinates={
            c: {"unit": unit, **({"imposed": True} if c == "h" else {})} for c in coordinates
        },
        parameters={
            "g": (9.81, "m/s^2"),
            "m_b": (350.0, "kg"),
            "m_w": (42.0, "kg"),
            "k_s": (22.0, "kN/m", 1.0),
            "l_s": (0.45, "m"),
            "d_s": (1.6, "kN*s/m"),
            "side": (0.35, "1"),
            "k_t": (195.0, "kN/m"),
            "r": (0.305, "m"),
        },
        points={"top": ["0", z], "hub": ["0", w], "contact": ["0", h]},
        bodies={"body": {"mass": "m_b", "at": "top"}, "wheel": {"mass": "m_w", "at": "hub"}},
        elements={
            "suspension": {"kind": "spring", **at("strut", "l_s"), "stiffness": "k_s"},
            "strut": {
                "kind": "damper",
                **at("strut"),
                "damping": "d_s",
                "asymmetry": "side",
            },
            "tyre": {"kind": "gap", **at("tyre", "r"), "side": "lower", "stiffness": "k_t"},
        },
        sensors={
            "body": {"measures": z, "unit": unit},
            "hub": {"measures": w, "unit": unit},
            "body_accel": {"measures": _primed(heights[0]), "unit": f"{unit}/s^2"},
        },
    )
    turn = [[float(c in part) for c in coordinates] for part in heights]
    return Writing(name, model, np.array(turn), places, {"strut": 0.45, "tyre": 0.305})
