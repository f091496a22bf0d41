"""What MuJoCo says along a motion: the force that its machine lacks there, and its slopes.

MuJoCo's inverse dynamics gives, at places q, rates v and accelerations a, the generalized force
that these need, with its contacts, limits, tendons, equalities and friction, in closed form:

    R(q, v, a, u) = M a + c(q, v) − p(q, v) − Jᵀf(q, v, a) − τ(q, v, u)
                    bias        passive    constraints       actuators and applied forces

Beside the measured motion, to first order,

    M̂ = ∂R/∂a,   M̂ a_free = M̂ a − R,   slopes −∂R/∂(q, v, u)        by central differences

M̂ is M where nothing holds; a soft contact adds Jᵀ D J to it, for MuJoCo's contact forces depend on
accelerations. It is the slope of the gradient of a convex function of a (MuJoCo's documentation,
Computation, Inverse dynamics), so it is symmetric and positive.

MuJoCo gets the bytes of one file, in a process of its own with limits; no file that it names is
opened. Sizes: N samples, n coordinates, k inputs, P parameters, S sets of them.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from symhyb.data.files.apart import Allowed, read_apart
from symhyb.data.files.extras import needed
from symhyb.data.files.table import Table, refusal
from symhyb.data.files.xml_file import parse_xml
from symhyb.data.hosts.answers import Answer, Array, Question
from symhyb.data.hosts.mjcf_file import TOUCHES, WEIGHS, problems_of, shown, stripped, touching
from symhyb.data.hosts.packed import packed, unpacked
from symhyb.errors import InputError, Problem, did_you_mean, visible
from symhyb.limits import FMU_CALLS_A_SECOND, FMU_SECONDS, ROBOT_BYTES, content_of
from symhyb.model.mujoco import Drive, Mujoco, Number

SLIDE, HINGE = 2, 3  # types of joints that have one coordinate
OBJECTS = {
    "actuator": "mjOBJ_ACTUATOR",
    "body": "mjOBJ_BODY",
    "geom": "mjOBJ_GEOM",
    "joint": "mjOBJ_JOINT",
    "site": "mjOBJ_SITE",
    "tendon": "mjOBJ_TENDON",
}


def ask(machine: Mujoco, path: Path, question: Question) -> Answer:
    """Let MuJoCo answer for the file at ``path``, in a process of its own.

    Raises:
        InputError: MuJoCo or defusedxml is not installed; no MJCF, or one that MuJoCo refuses; it
            names files or programs, lacks what is named, has other motions or states; it crashes
            or takes too long.
    """
    data = content_of_mjcf(path)
    allowed = Allowed(
        FMU_SECONDS + question.calls // FMU_CALLS_A_SECOND,
        "MuJoCo takes longer than the {} s that it gets for this recording; shorten the recording",
        "MuJoCo ended {}: it crashed; try the file in MuJoCo's own viewer",
    )
    table = read_apart(answered, _packed(machine, data, question), str(path), allowed)
    return Answer(*(column.values for column in table.columns))


def content_of_mjcf(path: Path) -> bytes:
    """The bytes of an MJCF that names no other files and no programs.

    Raises:
        InputError: defusedxml is not installed; there is no such file, or it is no such MJCF.
    """
    data = content_of(path, ROBOT_BYTES)
    problems = list(problems_of(parse_xml(data, str(path)), str(path)))
    if problems:
        raise InputError(problems)
    return data


def machine_from(words: dict[str, Any]) -> Mujoco:
    """What ``dataclasses.asdict`` made of a machine, after JSON."""
    return Mujoco(
        words["file"],
        tuple((name, joint) for name, joint in words["joints"]),
        tuple(Drive(**one) for one in words["inputs"]),
        tuple(Number(**one) for one in words["parameters"]),
    )


def _packed(machine: Mujoco, data: bytes, question: Question) -> bytes:
    return packed(asdict(machine), data=np.frombuffer(data, np.uint8), **question.arrays)


def answered(content: bytes, file: str) -> Table:
    """Let MuJoCo answer, in this process; the columns are the fields of an :class:`Answer`.

    Raises:
        InputError: as :func:`ask`.
    """
    words, arrays = unpacked(content)
    question = Question.of(arrays)
    engine = Engine.of(arrays["data"].tobytes(), machine_from(words), file)
    parts = []
    for values in question.values:
        engine.set(values)
        parts.append(_along(engine, question, file))
    return Answer(*(np.stack(column) for column in zip(*parts, strict=True))).table(file)


@dataclass(frozen=True, slots=True)
class Engine:
    """MuJoCo with a model and its data; where the coordinates are among its ``places`` and
    ``rates``; its ``controls``, and the inputs that are ``controlling`` them; what its inputs act
    by, and what its parameters set, each with the number of the part."""

    mujoco: Any
    model: Any
    data: Any
    places: list[int]
    rates: list[int]
    controls: list[int]
    controlling: list[int]
    drives: tuple[tuple[Drive, int], ...]
    numbers: tuple[tuple[Number, int], ...]

    @staticmethod
    def of(data: bytes, machine: Mujoco, file: str, steps: bool = False) -> "Engine":
        """MuJoCo with the model in ``data``, an MJCF, to be asked, or for ``steps``.

        Raises:
            InputError: what MuJoCo says of it; what is named and is not there; what moves or
                remembers beside the coordinates.
        """
        mujoco = needed("mujoco", "mjcf", file)
        mujoco.set_mju_user_warning(lambda said: None)  # else it writes a file where it runs
        model = _compiled(mujoco, data, file)
        named: tuple[Drive | Number, ...] = (*machine.inputs, *machine.parameters)
        parts = [
            *(("joint", joint) for _, joint in machine.joints),
            *((one.kind, one.part) for one in named),
        ]
        missing = [said for part in dict.fromkeys(parts) for said in _missing(mujoco, model, *part)]
        faults = missing or list(_beside(mujoco, model, machine))
        if faults:
            raise InputError([p for said in faults for p in refusal(file, said).problems])
        if steps:  # else MuJoCo begins anew where a run diverges
            model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        else:
            model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_INVDISCRETE)
            model.opt.integrator = int(mujoco.mjtIntegrator.mjINT_EULER)  # R is that of no step
        joints = [_number(mujoco, model, "joint", joint) for _, joint in machine.joints]
        drives = tuple((one, _of(mujoco, model, one)) for one in machine.inputs)
        acting = [i for i, (one, _) in enumerate(drives) if one.kind == "actuator"]
        return Engine(
            mujoco,
            model,
            mujoco.MjData(model),
            [int(model.jnt_qposadr[one]) for one in joints],
            [int(model.jnt_dofadr[one]) for one in joints],
            [int(model.actuator_ctrladr[drives[i][1]]) for i in acting],
            acting,
            drives,
            tuple((one, _of(mujoco, model, one)) for one in machine.parameters),
        )

    def set(self, values: Array) -> None:
        """Set the parameters to ``values`` (P,), SI."""
        for (number, part), value in zip(self.numbers, values, strict=True):
            into, where = _field(self.model, number, part)
            into[where] = value
        if self.numbers:
            self.mujoco.mj_setConst(self.model, self.data)

    def lacking(self, t: float, state: Array) -> Array:
        """The force (n,) that a motion under inputs needs and has not, at the ``state`` (3n + k,):
        places, rates, accelerations and inputs, all SI."""
        data, n = self.data, len(self.places)
        data.time = t
        data.qpos[self.places] = state[:n]
        data.qvel[self.rates] = state[n : 2 * n]
        data.qacc[self.rates] = state[2 * n : 3 * n]
        data.ctrl[self.controls] = state[3 * n :][self.controlling]
        self.mujoco.mj_inverse(self.model, data)
        self.mujoco.mj_fwdActuation(self.model, data)
        force = data.qfrc_inverse - data.qfrc_actuator
        for (drive, part), value in zip(self.drives, state[3 * n :], strict=True):
            if drive.kind != "actuator":
                force -= value * self._way(drive, part)
        return np.asarray(force[self.rates])

    def begin(self, q: Array, v: Array) -> None:
        """Set places and rates (n,), SI, from which steps begin."""
        self.data.qpos[self.places], self.data.qvel[self.rates] = q, v

    def state(self) -> tuple[Array, Array]:
        """Places and rates (n,), SI."""
        return np.array(self.data.qpos[self.places]), np.array(self.data.qvel[self.rates])

    def drive(self, u: Array, force: "Array | float") -> None:
        """Let inputs (k,) and a ``force`` (n,) on the coordinates act from now on, SI."""
        data = self.data
        data.ctrl[self.controls] = u[self.controlling]
        data.qfrc_applied[:] = 0.0
        data.qfrc_applied[self.rates] = force
        if len(self.controlling) < len(self.drives):
            self.mujoco.mj_fwdPosition(self.model, data)
        for (drive, part), value in zip(self.drives, u, strict=True):
            if drive.kind != "actuator":
                data.qfrc_applied += value * self._way(drive, part)

    def acceleration(self) -> Array:
        """The accelerations (n,), SI, under what acts."""
        self.mujoco.mj_forward(self.model, self.data)
        return np.array(self.data.qacc[self.rates])

    def step(self) -> None:
        """One step of MuJoCo."""
        self.mujoco.mj_step(self.model, self.data)

    def _way(self, drive: Drive, part: int) -> Array:
        """The generalized force (nv,) of a unit of an input, at the state that was set."""
        model, way = self.model, np.zeros(self.model.nv)
        if drive.kind == "joint":
            way[model.jnt_dofadr[part]] = 1.0
        elif drive.kind == "tendon":
            start = model.ten_J_rowadr[part]
            row = slice(start, start + model.ten_J_rownnz[part])
            way[model.ten_J_colind[row]] = self.data.ten_J[row]
        else:
            moved = np.zeros((3, model.nv))
            self.mujoco.mj_jacSite(model, self.data, moved, None, part)
            way = np.asarray(drive.along) / np.linalg.norm(drive.along) @ moved
        return way


def _compiled(mujoco: Any, data: bytes, file: str) -> Any:
    """MuJoCo's model of an MJCF, without what is out of files."""
    try:
        spec = mujoco.MjSpec.from_string(data.decode("utf-8-sig"))
        problems = [Problem(TOUCHES, f"geom.{name}", file) for name in touching(mujoco, spec)]
        problems += [Problem(WEIGHS, f"body.{name}", file) for name in stripped(mujoco, spec)]
        if not problems:
            return spec.compile()
    except (ValueError, RuntimeError, TypeError) as error:
        said = " ".join(visible(str(error)).split())
        raise InputError(Problem(f"MuJoCo says: {said}", file=file)) from None
    raise InputError(problems)


def _number(mujoco: Any, model: Any, kind: str, name: str) -> int:
    """The number of a part among its kind, -1 where there is none of this name."""
    return int(mujoco.mj_name2id(model, getattr(mujoco.mjtObj, OBJECTS[kind]), name))


def _missing(mujoco: Any, model: Any, kind: str, name: str) -> Iterator[str]:
    """What is said of a part that is named and is not there."""
    if _number(mujoco, model, kind, name) >= 0:
        return
    size = {"actuator": "nactuator", "joint": "njnt"}.get(kind, f"n{kind}")
    known = [getattr(model, kind)(i).name for i in range(getattr(model, size))]
    yield f"has no {kind} '{name}'{did_you_mean(name, [one for one in known if one])}"


def _beside(mujoco: Any, model: Any, machine: Mujoco) -> Iterator[str]:
    """What moves or remembers and is no coordinate; what the inverse dynamics leaves out; drives
    of more than one number."""
    named = {joint for _, joint in machine.joints}
    for i in range(model.njnt):
        name, one = shown(model.joint(i).name), model.jnt_type[i] in (SLIDE, HINGE)
        if not one:
            yield f"joint '{name or i + 1}' is neither hinge nor slide; only these are coordinates"
        elif not name:
            yield f"joint {i + 1} has no name; name it, and declare a coordinate for it"
        elif model.joint(i).name not in named:
            yield f"joint '{name}' moves and is no coordinate; declare one for it, with a sensor"
    held = (
        ("actuators with states of their own", model.na, 'give them dyntype="none"'),
        ("delays of actuators", model.nhistory, "state the delay in [inputs] of the model file"),
        ("plastic deformation", model.nplastic, "leave it out"),
        ("flexible bodies", model.nflex, "leave them out"),
        (
            "noslip_iterations",
            model.opt.noslip_iterations,
            "set it to 0: it is a correction of steps, of which the inverse dynamics knows none",
        ),
    )
    for what, there, cure in held:
        if there:
            yield f"has {what}, which cannot be asked at one state; {cure}"
    for drive in machine.inputs:
        if drive.kind == "actuator" and model.actuator_ctrlnum[_of(mujoco, model, drive)] != 1:
            yield f"the actuator '{drive.part}' has not one control; name one that has"


def _of(mujoco: Any, model: Any, one: Drive | Number) -> int:
    return _number(mujoco, model, one.kind, one.part)


def _field(model: Any, number: Number, part: int) -> tuple[Any, Any]:
    """The array that a parameter is in, and where."""
    if number.kind == "joint":
        dof, place = model.jnt_dofadr[part], model.jnt_qposadr[part]
        arrays = {
            "stiffness": (model.jnt_stiffness, part),
            "springref": (model.qpos_spring, place),
        }
        return arrays.get(number.field) or (getattr(model, f"dof_{number.field}"), dof)
    if number.kind == "geom":
        return model.geom_friction, (part, 0)  # along the surface; the others are of rotations
    return getattr(model, f"{number.kind}_{number.field}"), part


@np.errstate(over="ignore", invalid="ignore")
def _along(engine: Engine, question: Question, file: str) -> tuple[Array, Array, Array]:
    """M̂ (N, n, n), M̂·a_free (N, n) and −∂R/∂(q, v, u) (N, n, 2n + k) along a motion."""
    n, k = question.q.shape[1], question.u.shape[1]
    count = question.t.size
    mass, force = np.empty((count, n, n)), np.empty((count, n))
    slopes = np.empty((count, n, 2 * n + k))
    steps = np.concatenate([question.steps[: 2 * n], question.pulls, question.steps[2 * n :]])
    order = [*range(2 * n), *range(3 * n, 3 * n + k)]  # q, v and u among q, v, a and u
    for i, t in enumerate(question.t):
        state = np.concatenate([question.q[i], question.v[i], question.a[i], question.u[i]])
        lacks = engine.lacking(t, state)
        by = np.empty((n, state.size))
        for j, step in enumerate(steps):
            up, down = state.copy(), state.copy()
            up[j] += step
            down[j] -= step
            by[:, j] = (engine.lacking(t, up) - engine.lacking(t, down)) / (2 * step)
        inertia = by[:, 2 * n : 3 * n]
        mass[i] = (inertia + inertia.T) / 2
        force[i] = mass[i] @ question.a[i] - lacks
        slopes[i] = -by[:, order]
        if not all(np.isfinite(part[i]).all() for part in (mass, force, slopes)):
            raise refusal(file, f"MuJoCo gives a force that is not finite at {t:g} s")
    return mass, force, slopes
