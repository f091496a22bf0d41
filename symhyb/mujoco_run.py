"""A run of a machine that MuJoCo has: its own steps, with the elements of the model file beside it.

MuJoCo steps with the integrator and the step of its file, in a process of its own with limits.
Inputs act over a step with their value at its middle; the forces of elements are taken at its
beginning and held. Sizes: N samples, n coordinates, k inputs, K times of inputs, P parameters.
"""

from collections.abc import Callable, Iterator
from dataclasses import asdict, replace

import numpy as np

from symhyb.data.files.apart import Allowed, read_apart
from symhyb.data.files.table import Column, Table, refusal
from symhyb.data.hosts.mujoco_answers import Engine, content_of_mjcf, machine_from
from symhyb.data.hosts.packed import packed, unpacked
from symhyb.errors import InputError, Problem
from symhyb.limits import FMU_CALLS_A_SECOND, FMU_SECONDS, RUN_ROWS
from symhyb.model.bare import bare
from symhyb.model.read import parse_model
from symhyb.model.types import Energy
from symhyb.model.vocabulary import KINDS
from symhyb.model.write import text_of
from symhyb.numeric.kernels.buffers import Array, call, on_lines
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import Trajectory, bent
from symhyb.numeric.runs.scenario import Scenario

ON_STEP = 1e-6  # of a step: a time is that of a step

Force = Callable[[float, Array, Array, Array], Array]


def mujoco_run(machine: Machine, scenario: Scenario, p: Array | None = None) -> Trajectory:
    """Let MuJoCo run over ``scenario.t`` under its inputs, beside a ``machine`` that has what the
    model file says beside MuJoCo (:func:`symhyb.model.bare.bare`), with parameters ``p`` (P,), SI,
    by default those of the model. A run that diverges says so in its ``reason``.

    Raises:
        InputError: an element that is no force beside MuJoCo, for it has mass or remembers;
            declared states; or what :func:`symhyb.data.hosts.mujoco_answers.ask` refuses.
    """
    model = machine.model
    engine = model.mujoco
    if engine is None:
        raise ValueError("this machine is not MuJoCo's")
    _require_forces(machine)
    values = machine.values if p is None else np.asarray(p, dtype=float)
    acting, path = bent(scenario, machine, values), engine.path(model.file)
    words = {
        "engine": asdict(engine),
        "model": text_of(replace(model, energy=Energy(), local=None)) if model.elements else "",
        "file": model.file,
        "inputs": [item.name for item in model.inputs],
        "paths": [one.path for one in model.all_parameters()],
    }
    content = packed(
        words,
        data=np.frombuffer(content_of_mjcf(path), np.uint8),
        t=scenario.t,
        start=np.stack([scenario.q, scenario.v]),
        t_u=acting.t_u,
        u=acting.u,
        p=values,
    )
    allowed = Allowed(
        FMU_SECONDS + RUN_ROWS // FMU_CALLS_A_SECOND,
        "MuJoCo takes longer than the {} s that a run gets; shorten it",
        "MuJoCo ended {}: it crashed; try the file in MuJoCo's own viewer",
    )
    table = read_apart(stepped, content, str(path), allowed)
    q, v, a = (column.values for column in table.columns)
    u, nothing = on_lines(acting.t_u, acting.u, scenario.t), np.zeros((scenario.t.size, 0))
    given = (q, v, a, nothing, u, scenario.t, values)
    (y,) = along(machine.outputs, given, repeated=(6,), samples=scenario.t.size)
    lost = np.flatnonzero(~np.isfinite(q).all(axis=1))
    reason = f"MuJoCo's run diverges before {scenario.t[lost[0]]:.6g} s" if lost.size else ""
    return Trajectory(scenario.t, q, v, a, y, nothing, reason, "mujoco", model=model)


def _require_forces(machine: Machine) -> None:
    model = machine.model
    problems = [
        Problem(
            "has mass, which cannot act beside MuJoCo's steps; put it into MuJoCo's file",
            f"elements.{element.name}",
            model.file,
        )
        for element in model.elements
        if KINDS[element.kind].inertial
    ]
    if machine.inner_states:
        text = "what remembers (declared states, relaxation, …) is not simulated beside MuJoCo"
        problems.append(Problem(f"{text}; leave it out", "elements", model.file))
    if problems:
        raise InputError(problems)


def stepped(content: bytes, file: str) -> Table:
    """Let MuJoCo run, in this process; the columns are places, rates and accelerations (N, n), SI,
    NaN from where they are not finite.

    Raises:
        InputError: as :func:`mujoco_run`.
    """
    words, arrays = unpacked(content)
    data = arrays["data"].tobytes()
    t, start, t_u, u, p = (arrays[key] for key in ("t", "start", "t_u", "u", "p"))
    known = machine_from(words["engine"])
    engine = Engine.of(data, known, file, steps=True)
    engine.set(np.array([p[words["paths"].index(name)] for name in known.parameter_names]))
    h = float(engine.model.opt.timestep)
    steps = int(np.ceil((t[-1] - t[0]) / h)) + 1
    if steps > RUN_ROWS:
        said = f"a run of {t[-1] - t[0]:g} s has {steps:,} steps of {h:g} s, more than {RUN_ROWS:,}"
        raise refusal(file, said)
    middles = on_lines(t_u, u, t[0] + h * (np.arange(steps) + 0.5))
    mine = [words["inputs"].index(name) for name in known.input_names]
    force = _forces(words["model"], words["file"], p)
    engine.begin(start[0], start[1])
    rows = list(_rows(engine, t, middles, middles[:, mine], force))
    q, v, a = np.moveaxis(np.array(rows), 1, 0)
    return Table(file, tuple(Column(key, part) for key, part in zip("qva", (q, v, a), strict=True)))


def _forces(text: str, file: str, p: Array) -> Force | None:
    """The generalized force (n,) of the elements of a model by t, q, v and all inputs."""
    if not text:
        return None
    machine, nothing = build(bare(parse_model(text, file))), np.zeros(0)

    def force(t: float, q: Array, v: Array, u: Array) -> Array:
        return call(machine.k_e, (q, v, nothing, u, t, p))[0].reshape(-1)

    return force


def _rows(
    engine: Engine, t: Array, every: Array, mine: Array, force: Force | None
) -> Iterator[tuple[Array, Array, Array]]:
    """Place, rate and acceleration (n,) at the times ``t`` (N,), with all inputs at the middles of
    steps and those of MuJoCo among them; between two steps by cubics through places and rates."""
    h = float(engine.model.opt.timestep)
    at, row = (t - t[0]) / h, 0
    for k in range(every.shape[0]):
        q, v = engine.state()
        engine.drive(mine[k], 0.0 if force is None else force(t[0] + k * h, q, v, every[k]))
        while row < at.size and at[row] - k <= ON_STEP:
            yield q, v, engine.acceleration()
            row += 1
        if row == at.size:
            return
        engine.step()
        q_next, v_next = engine.state()
        while row < at.size and at[row] - k < 1 - ON_STEP:
            yield _between(q, v, q_next, v_next, h, at[row] - k)
            row += 1


def _between(
    q: Array, v: Array, q_next: Array, v_next: Array, h: float, share: float
) -> tuple[Array, Array, Array]:
    """Place, rate and acceleration (n,) at a ``share`` of a step of ``h`` s."""
    s = share
    moved, curve = q_next - q, h * (v + v_next)
    place = q + h * v * s + (3 * moved - h * (2 * v + v_next)) * s**2 + (curve - 2 * moved) * s**3
    return place, v + s * (v_next - v), (v_next - v) / h
