"""Small machines for tests, each the text of a model file, read like one.

One mapping a section: ``model_of(coordinates={"x": {"unit": "m"}}, …)``; a parameter may be written
short as (value, unit) or (value, unit, sd).
"""

import json
from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from symhyb.data.recording import Recording
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

Array = NDArray[np.float64]
Entries = Mapping[str, object]


DRIVEN_MASS = """symhyb = 1
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 1.0, unit = "kg" }
k = { value = 25.0, unit = "N/m", sd = 0.5 }
d = { value = 0.6, unit = "N*s/m" }
[inputs]
f = { unit = "N" }
[bodies.mass]
mass = "m"
at = ["x", "0"]
[elements.spring]
kind = "spring"
on = "x"
stiffness = "k"
[elements.damper]
kind = "damper"
on = "x"
damping = "d"
[elements.push]
kind = "force"
on = "x"
force = "f"
[sensors]
laser = { measures = "x", unit = "m" }
"""
"""The text of a mass on a spring and a damper, pushed by an input; more may be appended."""


def model_of(gravity: list[str] | None = None, **sections: Entries) -> Model:
    """Read the model that these sections say."""
    lines = ["symhyb = 1", 'title = "test"']
    if gravity is not None:
        lines.append(f"gravity = {_toml(gravity)}")
    for section, entries in sections.items():
        lines.append(f"[{section}]")
        lines += [f"{name} = {_toml(_long(entry))}" for name, entry in entries.items()]
    return parse_model("\n".join(lines) + "\n", "test.toml")


def _long(entry: object) -> object:
    if isinstance(entry, tuple):
        return dict(zip(("value", "unit", "sd"), entry, strict=False))
    return entry


def _toml(value: object) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{k} = {_toml(_long(v))}" for k, v in value.items()) + " }"
    return json.dumps(value)


def spring(stiffness: str, on: str = "x", **more: object) -> Entries:
    return {"kind": "spring", "on": on, "stiffness": stiffness, **more}


def damper(damping: str, on: str = "x") -> Entries:
    return {"kind": "damper", "on": on, "damping": damping}


def push(force: str, on: str = "x") -> Entries:
    return {"kind": "force", "on": on, "force": force}


def cart_and_pole(rubs: bool = False) -> Model:
    r"""A pole of 0.4 m hangs from a cart that is held by a spring; the joint may rub.

    wall |--/\/\/--[cart]--> x
                     \  phi
    """
    elements: dict[str, object] = {
        "spring": {"kind": "spring", "on": "x", "stiffness": "k"},
    }
    if rubs:
        elements["joint"] = damper("d", "phi")
    return model_of(
        gravity=["0", "-g"],
        coordinates={"x": {"unit": "m", "start": 0.1}, "phi": {"unit": "rad", "start": 1.2}},
        parameters={
            "g": (9.81, "m/s^2"),
            "M": (1.0, "kg"),
            "m": (0.5, "kg"),
            "l": (0.4, "m"),
            "k": (30.0, "N/m"),
            "d": (0.02, "N*m*s"),
        },
        bodies={
            "cart": {"mass": "M", "at": ["x", "0"]},
            "bob": {"mass": "m", "at": ["x + l*sin(phi)", "-l*cos(phi)"]},
        },
        elements=elements,
        sensors={"x": {"measures": "x", "unit": "m"}, "pull": {"measures": "x''", "unit": "m/s^2"}},
    )


def oscillator(
    elements: Mapping[str, Entries],
    parameters: Entries | None = None,
    sensors: Mapping[str, Entries] | None = None,
    inputs: Mapping[str, Entries] | None = None,
    start: float = 0.0,
) -> Model:
    r"""A mass m = 1.2 kg on a line; its place is measured unless ``sensors`` say else.

    wall o--/\/\/--[m]--> x        the wall is at −2 m
    """
    return model_of(
        coordinates={"x": {"unit": "m", "start": start}},
        parameters={"m": (1.2, "kg"), "far": (2.0, "m"), **(parameters or {})},
        inputs=inputs or {},
        points={"wall": ["-far", "0"], "block": ["x", "0"]},
        bodies={"block": {"mass": "m", "at": "block"}},
        elements=elements,
        sensors=sensors or {"place": {"measures": "x", "unit": "m", "sd": 1e-3}},
    )


def pendulum(**more: Entries) -> Model:
    """A rod that hangs from the origin: phi counter-clockwise from hanging down."""
    return model_of(
        gravity=["0", "-g"],
        coordinates={"phi": {"unit": "rad", "start": 0.5}},
        parameters={"g": (9.81, "m/s^2"), "m": (0.4, "kg"), "l": (0.3, "m"), "J": (0.01, "kg*m^2")},
        points={"centre": ["l*sin(phi)", "-l*cos(phi)"]},
        bodies={"rod": {"mass": "m", "at": "centre", "inertia": "J", "angle": "phi"}},
        **more,
    )


def cart_pole(
    order: tuple[str, str] = ("x", "phi"), length: str = "m", angle: str = "rad"
) -> Model:
    """A cart with a hanging pole, a spring from a post to the tip, friction, drag and a motor.

    ``length`` and ``angle`` are the units of the coordinates, ``order`` that of their names.
    """
    units = {"x": {"unit": length, "start": 0.0}, "phi": {"unit": angle, "start": 0.0}}
    return model_of(
        gravity=["0", "-g"],
        coordinates={name: units[name] for name in order},
        parameters={
            "g": (9.81, "m/s^2"),
            "m_c": (0.6, "kg"),
            "m_p": (0.25, "kg"),
            "a": (0.3, "m"),
            "J": (7.5e-3, "kg*m^2"),
            "d": (0.02, "N*m*s/rad"),
            "k": (25.0, "N/m"),
            "rest": (0.35, "m"),
            "c": (0.8, "N"),
            "w": (0.05, "m/s"),
            "b": (0.3, "N*s^2/m^2"),
        },
        inputs={"pull": {"unit": "N"}},
        points={
            "pivot": ["x", "0"],
            "centre": ["x + a*sin(phi)", "-a*cos(phi)"],
            "tip": ["x + 2*a*sin(phi)", "-2*a*cos(phi)"],
            "post": ["1.5*a", "-2*a"],
        },
        bodies={
            "cart": {"mass": "m_c", "at": "pivot"},
            "pole": {"mass": "m_p", "at": "centre", "inertia": "J", "angle": "phi"},
        },
        elements={
            "motor": push("pull"),
            "bearing": damper("d", on="phi"),
            "band": {
                "kind": "spring",
                "between": ["post", "tip"],
                "stiffness": "k",
                "length": "rest",
            },
            "rail": {"kind": "friction", "on": "x", "coulomb": "c", "transition": "w"},
            "air": {"kind": "drag", "on": "x", "drag": "b"},
        },
        sensors={
            "cart": {"measures": "x", "unit": "m", "sd": 1e-4},
            "pole": {"measures": "phi", "unit": "rad", "sd": 1e-3},
            "accel": {"measures": "x''", "unit": "m/s^2", "sd": 1e-2},
        },
    )


def double_pendulum() -> Model:
    """Two point masses on two rods, declared by their places only."""
    return model_of(
        gravity=["0", "-g"],
        coordinates={"alpha": {"unit": "rad", "start": 0.3}, "beta": {"unit": "rad"}},
        parameters={
            "g": (9.81, "m/s^2"),
            "l1": (0.7, "m"),
            "l2": (0.4, "m"),
            "m1": (1.3, "kg"),
            "m2": (0.6, "kg"),
        },
        points={
            "elbow": ["l1*sin(alpha)", "-l1*cos(alpha)"],
            "hand": ["l1*sin(alpha) + l2*sin(beta)", "-l1*cos(alpha) - l2*cos(beta)"],
        },
        bodies={"upper": {"mass": "m1", "at": "elbow"}, "lower": {"mass": "m2", "at": "hand"}},
    )


def value(function: ca.Function, *arguments: ArrayLike) -> Array:
    """The first output of a CasADi function at one point: (rows,), or (columns, rows)."""
    (first, *_) = call(function, [np.asarray(argument, float) for argument in arguments])
    return first[0] if len(first) == 1 else first


def run(
    model: Model | Machine,
    t: ArrayLike,
    q: ArrayLike,
    v: ArrayLike = 0.0,
    u: ArrayLike | None = None,
    t_u: ArrayLike | None = None,
) -> Trajectory:
    """Simulate from q and v; inputs ``u`` (K, k) at ``t_u``, default at the output times."""
    machine = model if isinstance(model, Machine) else build(model)
    t = np.asarray(t, float)
    t_u = t if t_u is None else np.asarray(t_u, float)
    inputs = np.empty((t_u.size, 0)) if u is None else np.asarray(u, float).reshape(t_u.size, -1)
    q = np.broadcast_to(np.asarray(q, float), (machine.n,))
    v = np.broadcast_to(np.asarray(v, float), (machine.n,))
    return simulate(machine, Scenario(t, q, v, t_u, inputs))


def recording(t: Array, inputs: Mapping[str, Array] | None = None, **sensors: Array) -> Recording:
    """A recording in SI as if it had been read from a file."""
    return Recording("test.csv", t, inputs or {}, sensors, (), "")


def driven_joints(inertia: Array | Sequence[float], stiffness: float) -> Model:
    """Joints q0, q1 … of this ``inertia``, kg·m², each driven and on a spring, N·m/rad, that know
    no loss."""
    names = [f"q{i}" for i in range(len(inertia))]
    springs = {f"spring{n}": {"kind": "spring", "on": n, "stiffness": "k"} for n in names}
    motors = {f"motor{n}": {"kind": "law", "on": n, "torque": f"t{n}"} for n in names}
    kinetic = " + ".join(f"J{i}*q{i}'**2/2" for i in range(len(inertia)))
    return model_of(
        coordinates={name: {"unit": "rad"} for name in names},
        parameters={
            "k": (stiffness, "N*m/rad"),
            **{f"J{i}": (float(one), "kg*m^2") for i, one in enumerate(inertia)},
        },
        inputs={f"t{n}": {"unit": "N*m", "between": "smooth"} for n in names},
        energy={"kinetic": kinetic},
        elements={**springs, **motors},
        sensors={f"encoder{i}": {"measures": n, "unit": "rad"} for i, n in enumerate(names)},
    )
