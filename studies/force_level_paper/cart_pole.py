r"""The same on a machine with two coordinates: a pole on a driven cart, in both hosts.

    wall |--/\/\--[ cart ]--> x        what lacks: dry friction on the cart, drag in the joint
                      \
                       o phi           M(q) is full: a law of forces is no simple law of rates

    python studies/force_level_paper/cart_pole.py --seeds 30-34
"""

import argparse
import json
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import hosts
import learn
import numpy as np
import truth
from run import STEPS, error, rounded
from truth import Array, Data, Drive, Plant

import symhyb as sh
from symhyb import Scenario
from symhyb.learning import (
    Correction,
    lacking,
    measured_course,
    simulate_corrected,
    sparse_law,
)
from symhyb.model.read import parse_model
from symhyb.model.write import append_elements

KEPT = Path(__file__).resolve().parent / "results" / "cart_pole.json"
START = np.array([0.1, 0.6])
M, MP, L, J, K = 1.0, 0.4, 0.5, 0.02, 40.0  # kg, kg, m, kg m², N/m
COULOMB, DRAG = 0.4, 0.03  # N, N m s²
DRIVE = Drive(4.0, 0.7)
UNSEEN = Drive(6.0, 0.5)
LIBRARY = (
    "x",
    "x'",
    "phi'",
    "abs(x')*x'",
    "abs(phi')*phi'",
    "tanh(x'/0.001)",
    "sin(phi)",
    "cos(phi)*phi'",
    "cos(phi)*x'",
    "cos(phi)*abs(phi')*phi'",
    "cos(phi)*tanh(x'/0.001)",
)

TEXT = """symhyb = 1
title = "Pole on a driven cart"
gravity = ["0", "-g"]
[coordinates]
x = {{ unit = "m", start = 0.1 }}
phi = {{ unit = "rad", start = 0.6 }}
[parameters]
g = {{ value = 9.81, unit = "m/s^2" }}
M = {{ value = {m!r}, unit = "kg" }}
m = {{ value = {mp!r}, unit = "kg" }}
l = {{ value = {l!r}, unit = "m" }}
J = {{ value = {j!r}, unit = "kg*m^2" }}
k = {{ value = {k!r}, unit = "N/m" }}
F = {{ value = {amplitude!r}, unit = "N" }}
f = {{ value = {frequency!r}, unit = "Hz" }}
[bodies.cart]
mass = "M"
at = ["x", "0"]
[bodies.pole]
mass = "m"
at = ["x + l*sin(phi)", "-l*cos(phi)"]
inertia = "J"
angle = "phi"
[elements.spring]
kind = "spring"
on = "x"
stiffness = "k"
[elements.drive]
kind = "harmonic"
on = "x"
amplitude = "F"
frequency = "f"
[sensors]
{sensors}
"""

XML = f"""<mujoco><option gravity="0 0 -{truth.G}" integrator="RK4" timestep="{{h}}">
<flag contact="disable"/></option><worldbody><body>
<joint name="x" type="slide" axis="1 0 0" stiffness="{K}"/>
<inertial pos="0 0 0" mass="{M}" diaginertia="1 1 1"/>
<body><joint name="phi" type="hinge" axis="0 -1 0"/>
<inertial pos="0 0 -{L}" mass="{MP}" diaginertia="{J} {J} {J}"/></body></body></worldbody>
<actuator><motor joint="x"/></actuator></mujoco>"""


def plant(drive: Drive) -> Plant:
    """The machine, its equations by hand."""

    def mass(q: Array) -> Array:
        off = MP * L * np.cos(q[1])
        return np.array([[M + MP, off], [off, MP * L**2 + J]])

    def force(t: float, q: Array, v: Array) -> Array:
        along = drive(t) - K * q[0] + MP * L * np.sin(q[1]) * v[1] ** 2
        return np.array([along, -MP * truth.G * L * np.sin(q[1]) - DRAG * abs(v[1]) * v[1]])

    return Plant(mass, force, COULOMB)


def model_of(drive: Drive, data: Data) -> sh.Model:
    """The model file, without friction and drag."""
    names, units = ("x", "phi"), ("m", "rad")
    lines = [
        f'{name}{order} = {{ measures = "{name}{chr(39) * order}", '
        f'unit = "{unit}{("", "/s", "/s^2")[order]}", sd = {float(data.sd[order, i])!r} }}'
        for i, (name, unit) in enumerate(zip(names, units, strict=True))
        for order in range(3)
    ]
    return parse_model(
        TEXT.format(
            m=M,
            mp=MP,
            l=L,
            j=J,
            k=K,
            amplitude=drive.amplitude,
            frequency=drive.frequency,
            sensors="\n".join(lines),
        )
    )


@dataclass(frozen=True, slots=True)
class ExudynCartPole:
    """A kinematic tree of two links; spring by its joint control, forces by its user function."""

    drive: Drive

    def run(self, law: hosts.Law | None, t: Array, h: float) -> tuple[Array, Array]:
        import exudyn as exu
        from exudyn import itemInterface as items  # noqa: N813

        kept, drive = hosts.Kept(law, 2, h), self.drive
        system = exu.SystemContainer()
        mbs = system.AddSystem()
        node = mbs.AddNode(
            items.NodeGenericODE2(
                referenceCoordinates=[0, 0],
                initialCoordinates=START.tolist(),
                initialCoordinates_t=[0, 0],
                numberOfODE2Coordinates=2,
            )
        )

        def forces(mbs: Any, t: float, number: int, q: Any, v: Any) -> list[float]:
            added = kept.now(t, q, v)
            return [drive(t) + added[0], added[1]]

        eye, zero = np.eye(3), [0.0, 0.0, 0.0]
        mbs.AddObject(
            items.ObjectKinematicTree(
                nodeNumber=node,
                gravity=[0, -truth.G, 0],
                jointTypes=[exu.JointType.PrismaticX, exu.JointType.RevoluteZ],
                linkParents=[-1, 0],
                jointTransformations=exu.Matrix3DList([eye, eye]),
                linkInertiasCOM=exu.Matrix3DList([eye, J * eye]),
                linkCOMs=exu.Vector3DList([zero, [0.0, -L, 0.0]]),
                jointOffsets=exu.Vector3DList([zero, zero]),
                linkForces=exu.Vector3DList([zero] * 2),
                linkTorques=exu.Vector3DList([zero] * 2),
                linkMasses=[M, MP],
                jointPControlVector=[K, 0.0],
                jointDControlVector=[0.0, 0.0],
                jointPositionOffsetVector=[0.0, 0.0],
                jointVelocityOffsetVector=[0.0, 0.0],
                forceUserFunction=forces,
            )
        )
        mbs.Assemble()

        def state() -> tuple[Array, Array]:
            kinds = (exu.OutputVariableType.Coordinates, exu.OutputVariableType.Coordinates_t)
            q, v = (np.array(mbs.GetNodeOutput(node, kind)) for kind in kinds)
            return q, v

        return hosts.exudyn_run(exu, mbs, state, kept, t, h)


def host_of(name: str, drive: Drive) -> hosts.Host:
    if name == "Exudyn":
        return ExudynCartPole(drive)
    return hosts.MujocoHost(XML, drive, tuple(START.tolist()))


def scenario_of() -> Scenario:
    t = truth.times(10.0)
    return Scenario(t, START, np.zeros(2), t, np.empty((t.size, 0)))


def one(seed: int, steps: tuple[float, ...] = STEPS) -> dict[str, Any]:
    """All that is measured with one seed of the noise."""
    data = truth.measured(plant(DRIVE), truth.times(), START, np.zeros(2), seed)
    model, rows = model_of(DRIVE, data), np.flatnonzero(data.train)
    machine = sh.build(model)
    sensors = {
        f"{name}{order}": column[rows, i]
        for i, name in enumerate(("x", "phi"))
        for order, column in enumerate((data.q, data.v, data.a))
    }
    recording = sh.Recording("recording", data.t[rows], {}, sensors, (), "")
    motion = (data.q[rows], data.v[rows], data.a[rows])
    course = measured_course(machine, data.t[rows], motion, np.empty((rows.size, 0)))
    diagnosis = sh.diagnose(model, recording)
    nets = learn.default_networks(machine, course, "force", seed)
    elements = {
        "default": tuple(learn.default_element(nets, i, on) for i, on in enumerate(("x", "phi"))),
        "sparse": tuple(item.element for item in diagnosis.found),
    }
    rates = {
        "default": learn.default_networks(machine, course, "rates", seed),
        "sparse": sparse_law(
            machine, course, lacking(machine, course, "rates"), LIBRARY, learn.THRESHOLD
        ),
    }
    reported: dict[str, Any] = {
        "seed": seed,
        "said": diagnosis.sentence,
        "simulated": {},
        "hosts": {},
    }
    for name, drive in (("as recorded", DRIVE), ("unseen", UNSEEN)):
        here, scenario = model_of(drive, data), scenario_of()
        exact = truth.simulate(plant(drive), scenario.t, START, np.zeros(2))
        alone = simulate_corrected(sh.build(here), scenario)
        reported["simulated"][name] = {"alone": {"force": error(alone.q, alone.v, exact)}}
        for row, own in elements.items():
            corrected = append_elements(here, list(own)) if own else here
            force = simulate_corrected(sh.build(corrected), scenario)
            rate = simulate_corrected(
                machine if name == "as recorded" else sh.build(here),
                scenario,
                Correction("rates", (rates[row],)),
            )
            reported["simulated"][name][row] = {
                "force": error(force.q, force.v, exact),
                "rates": error(rate.q, rate.v, exact),
            }
            if name == "as recorded" and own:
                reported["hosts"][row] = in_hosts(
                    corrected, tuple(e.name for e in own), exact, (force.q, force.v), steps
                )
    return reported


def in_hosts(
    model: sh.Model,
    names: tuple[str, ...],
    exact: truth.Run,
    cvodes: tuple[Array, Array],
    steps: tuple[float, ...],
) -> dict[str, Any]:
    """Errors and coupling errors by host, coupling and step."""
    table: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder:
        made = hosts.written(model, names, Path(folder))
        for host in hosts.HOSTS:
            for coupling in hosts.COUPLINGS:
                for h in steps:
                    with hosts.law_of(*made, coupling) as law:
                        q, v = host_of(host, DRIVE).run(law, scenario_of().t, h)
                    row = {"error": error(q, v, exact), "coupling": error(q, v, cvodes)}
                    table.setdefault(host, {}).setdefault(coupling, {})[f"{h:g}"] = row
    return table


def main() -> None:
    """Run some seeds and keep all of them in one file."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="30-34")
    parser.add_argument("--results", type=Path, default=KEPT)
    options = parser.parse_args()
    first, _, last = options.seeds.partition("-")
    reported = [one(seed) for seed in range(int(first), int(last or first) + 1)]
    for row in reported:
        print(row["seed"], row["said"])
    lines = ",\n".join(json.dumps(rounded(row)) for row in reported)
    options.results.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
