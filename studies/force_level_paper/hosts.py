"""The same machine built in Exudyn and in MuJoCo, and ΔF added through their interfaces of forces.

    casadi   the law as a CasADi function, asked within every stage of the host's Runge–Kutta step
    cs       the compiled FMU for co-simulation, in lock step: asked before a step, held over it
    me       the compiled FMU for model exchange, asked within every stage

Both hosts integrate by the classical Runge–Kutta method of order 4 with a fixed step. The host adds
+ΔF; a spring-damper of Exudyn resists, so that its function returns −ΔF.
"""

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from truth import STEP, Array, Drive, Oscillator

import symhyb as sh
from symhyb.export.fmu import fmu
from symhyb.export.spec import Spec, spec_of

COUPLINGS = ("casadi", "cs", "me")
HOSTS = ("Exudyn", "MuJoCo")
Forces = Callable[[float, Any, Any], list[float]]


@dataclass(frozen=True, slots=True)
class Law:
    """ΔF (n,) at a time, positions and speeds, SI; ``advance`` (t, h) lets a co-simulation step;
    ``held`` says that the force is to be kept over a step of the host."""

    force: Forces
    advance: Callable[[float, float], object]
    held: bool


class Host(Protocol):
    """A machine in another program."""

    def run(self, law: Law | None, t: Array, h: float) -> tuple[Array, Array]:
        """q, v (N, n) at the times ``t`` (N,), multiples of the step ``h``, s."""


def written(model: sh.Model, elements: tuple[str, ...], folder: Path) -> tuple[Spec, Path]:
    """The elements alone as an FMU 2.0 for both kinds of coupling, as ``symhyb export`` does."""
    spec = spec_of(model, "correction", elements)
    path = folder / "correction.fmu"
    path.write_bytes(fmu(spec, 2, platforms=("linux64",)))
    return spec, path


@contextmanager
def law_of(spec: Spec, path: Path, coupling: str) -> Iterator[Law]:
    """The law by one of the couplings."""
    names = [c.name for c in spec.exported.model.coordinates]
    seen = [("qv".index(kind), names.index(name)) for kind, name in spec.exported.inputs]
    acts = [
        (i, names.index(n)) for i, (kind, n) in enumerate(spec.exported.outputs) if kind == "dF"
    ]
    if coupling == "casadi":
        yield Law(_by_casadi(spec, seen, acts, len(names)), lambda t, h: None, False)
        return
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Model, FMU2Slave, fmi2Real, fmi2ValueReference

    description = read_model_description(str(path))
    with tempfile.TemporaryDirectory() as folder:
        made = (FMU2Model if coupling == "me" else FMU2Slave)(
            guid=description.guid,
            unzipDirectory=extract(str(path), folder),
            modelIdentifier=description.modelName,
            instanceName="law",
        )
        made.instantiate()
        made.setupExperiment(startTime=0.0)
        made.enterInitializationMode()
        made.exitInitializationMode()
        if coupling == "me":
            made.enterContinuousTimeMode()
        given, asked = (spec.of_role(role) for role in ("input", "output"))
        inputs, outputs = (
            (fmi2ValueReference * len(part))(*(v.reference for v in part))
            for part in (given, asked[: len(acts)])
        )
        into, out = (fmi2Real * len(given))(), (fmi2Real * len(acts))()

        def force(t: float, q: Any, v: Any) -> list[float]:
            if coupling == "me":
                made.setTime(t)
            for place, (kind, i) in enumerate(seen):
                into[place] = (q, v)[kind][i]
            made.fmi2SetReal(made.component, inputs, len(given), into)
            made.fmi2GetReal(made.component, outputs, len(acts), out)
            result = [0.0] * len(names)
            for (_, i), value in zip(acts, out, strict=True):
                result[i] = value
            return result

        advance = made.doStep if coupling == "cs" else (lambda t, h: None)
        yield Law(force, advance, coupling == "cs")
        made.terminate()
        made.freeInstance()


def _by_casadi(
    spec: Spec, seen: list[tuple[int, int]], acts: list[tuple[int, int]], n: int
) -> Forces:
    """The exported function on buffers of its own."""
    function = spec.exported.value
    buffer, trigger = function.buffer()
    x, t, u = spec.exported.x.copy(), np.zeros(1), spec.exported.u.copy()
    rates, y = np.zeros(spec.exported.x.size), np.zeros(len(spec.exported.outputs))
    for i, part in enumerate((t, x, u, spec.exported.p)):
        buffer.set_arg(i, memoryview(part))
    for i, part in enumerate((rates, y)):
        if part.size:
            buffer.set_res(i, memoryview(part))

    def force(now: float, q: Any, v: Any, alive: Any = (function, buffer, x, rates)) -> list[float]:
        t[0] = now  # the buffer knows addresses alone: what they belong to must stay
        for place, (kind, i) in enumerate(seen):
            u[place] = (q, v)[kind][i]
        trigger()
        result = [0.0] * n
        for row, i in acts:
            result[i] = float(y[row])
        return result

    return force


class Kept:
    """The force that acts now: of this very state, or that of the beginning of the step."""

    def __init__(self, law: Law | None, n: int, h: float):
        self.law, self.h, self.last = law, h, [0.0] * n

    def begin(self, t: float, q: Any, v: Any) -> None:
        """Before each step of the host."""
        if self.law is not None and self.law.held:
            self.last = self.law.force(t, q, v)
            self.law.advance(t, self.h)

    def now(self, t: float, q: Any, v: Any) -> list[float]:
        if self.law is None or self.law.held:
            return self.last
        return self.law.force(t, q, v)


@dataclass(frozen=True, slots=True)
class ExudynOscillator:
    """Mass1D on a coordinate spring-damper; ΔF by another one, F by a load."""

    it: Oscillator
    drive: Drive

    def run(self, law: Law | None, t: Array, h: float) -> tuple[Array, Array]:
        import exudyn as exu
        from exudyn import itemInterface as items  # noqa: N813

        kept, c, drive = Kept(law, 1, h), self.it.c, self.drive
        system = exu.SystemContainer()
        mbs = system.AddSystem()
        ground = mbs.AddNode(items.NodePointGround())
        node = mbs.AddNode(
            items.Node1D(
                referenceCoordinates=[0], initialCoordinates=[self.it.q0], initialVelocities=[0]
            )
        )
        mbs.AddObject(items.ObjectMass1D(mass=self.it.m, nodeNumber=node))
        wall, mass = (
            mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=n, coordinate=0))
            for n in (ground, node)
        )

        def cubic(mbs: Any, t: float, number: int, q: float, v: float, *_: float) -> float:
            return c * q**3

        def missing(mbs: Any, t: float, number: int, q: float, v: float, *_: float) -> float:
            return -kept.now(t, (q,), (v,))[0]  # a spring resists

        for law_of_spring in (cubic, missing):
            spring = items.CoordinateSpringDamper(markerNumbers=[wall, mass])
            spring.springForceUserFunction = law_of_spring
            mbs.AddObject(spring)
        push = items.LoadCoordinate(markerNumber=mass, load=1.0)
        push.loadUserFunction = lambda mbs, t, load: drive(t)
        mbs.AddLoad(push)
        mbs.Assemble()

        def state() -> tuple[Array, Array]:
            kinds = (exu.OutputVariableType.Coordinates, exu.OutputVariableType.Coordinates_t)
            q, v = (np.atleast_1d(mbs.GetNodeOutput(node, kind)) for kind in kinds)
            return q, v

        return exudyn_run(exu, mbs, state, kept, t, h)


def exudyn_run(
    exu: Any, mbs: Any, state: Callable[[], tuple[Array, Array]], kept: Kept, t: Array, h: float
) -> tuple[Array, Array]:
    """Solve with RK44 and collect every output."""
    every, count, rows = round(STEP / h), [0], []

    def before(mbs: Any, _end_of_step: float) -> bool:
        q, v = state()
        kept.begin(count[0] * h, q, v)
        if count[0] % every == 0:
            rows.append((q.copy(), v.copy()))
        count[0] += 1
        return True

    mbs.SetPreStepUserFunction(before)
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(t[-1] / h)
    settings.timeIntegration.endTime = float(t[-1])
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = float(t[-1])
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
    rows.append(state())
    q, v = (np.array([row[i] for row in rows])[: t.size] for i in (0, 1))
    return q, v


@dataclass(frozen=True, slots=True)
class MujocoHost:
    """A model in MuJoCo's XML; its first coordinate is pushed by the drive through a motor; ΔF goes
    into the passive forces."""

    xml: str
    drive: Drive
    start: tuple[float, ...]

    def run(self, law: Law | None, t: Array, h: float) -> tuple[Array, Array]:
        import mujoco

        model = mujoco.MjModel.from_xml_string(self.xml.format(h=h))
        data = mujoco.MjData(model)
        data.qpos[:] = self.start
        kept, every, rows = Kept(law, model.nv, h), round(STEP / h), []

        def push(model: Any, data: Any) -> None:
            data.ctrl[0] = self.drive(data.time)

        def passive(model: Any, data: Any) -> None:
            data.qfrc_passive[:] += kept.now(data.time, data.qpos, data.qvel)

        try:  # callbacks belong to the process
            mujoco.set_mjcb_control(push)
            mujoco.set_mjcb_passive(passive)
            for i in range(round(t[-1] / h) + 1):
                if i % every == 0:
                    rows.append((data.qpos.copy(), data.qvel.copy()))
                kept.begin(i * h, data.qpos, data.qvel)
                mujoco.mj_step(model, data)
        finally:
            mujoco.set_mjcb_control(None)
            mujoco.set_mjcb_passive(None)
        q, v = (np.array([row[i] for row in rows])[: t.size] for i in (0, 1))
        return q, v


OSCILLATOR_XML = """<mujoco><option gravity="0 0 0" integrator="RK4" timestep="{{h}}">
<flag contact="disable" energy="disable"/></option>
<worldbody><body><joint name="q" type="slide" axis="1 0 0" stiffness="0 0 {c!r}"/>
<inertial pos="0 0 0" mass="{m!r}" diaginertia="1 1 1"/></body></worldbody>
<actuator><motor joint="q"/></actuator></mujoco>"""


def oscillator_in(host: str, it: Oscillator, drive: Drive) -> Host:
    """The oscillator without drag and friction in a host."""
    if host == "Exudyn":
        return ExudynOscillator(it, drive)
    return MujocoHost(OSCILLATOR_XML.format(c=it.c, m=it.m), drive, (it.q0,))
