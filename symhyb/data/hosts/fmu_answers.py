"""What an FMU says along a motion: its mass matrix, its force and their slopes, by FMPy.

At every sample the FMU is set to the measured state and asked for accelerations (model exchange,
or co-simulation begun anew at that state). It runs in a process of its own, with a limit of time.

    a = a_free + G F       G = M⁻¹, from the input of force of every coordinate, or stated
    F* = M (a_measured − a_free),  and ∂a/∂(q, v, u) by central differences under F*

Sizes: N samples, n coordinates, k inputs, P parameters, S sets of them.
"""

import os
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from ctypes import Array as CArray
from ctypes import c_double, c_uint32
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from symhyb.data.files.apart import Allowed, read_apart
from symhyb.data.files.extras import needed
from symhyb.data.files.table import Table, refusal
from symhyb.data.hosts.answers import Answer, Array, Question
from symhyb.data.hosts.packed import packed, unpacked
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.limits import FMU_BYTES, FMU_CALLS_A_SECOND, FMU_SECONDS, FMU_UNPACKED, content_of
from symhyb.model.fmu import Fmu

TRUST = "SYMHYB_TRUST_FMU"  # the environment variable that lets FMUs run
EXACT = 1e-6  # relative: of differences of an FMU's answers, what must be equal
PUSH = 1.0  # N or N·m: a force is linear in accelerations, so that any will do
PROBES = 5  # samples at which that is checked


def ask(fmu: Fmu, path: Path, question: Question) -> Answer:
    """Let the FMU at ``path`` answer, in a process of its own.

    Raises:
        InputError: nobody said that FMUs may run; FMPy is not installed; no FMU, one without the
            variables that are named or with more states; it fails, crashes or takes too long;
            forces that do not act along the coordinates.
    """
    if os.environ.get(TRUST) != "1":
        text = "an FMU is a program that runs with your rights; if you trust its maker, set"
        raise InputError(Problem(f"{text} {TRUST}=1", "fmu.file", str(path)))
    needed("fmpy", "fmi", str(path))
    content_of(path, FMU_BYTES)
    seconds = FMU_SECONDS + question.calls // FMU_CALLS_A_SECOND
    allowed = Allowed(
        seconds,
        "the FMU takes longer than the {} s that it gets for this recording; shorten the recording",
        "the FMU ended {}: it crashed; try it in another program that imports FMUs",
    )
    with tempfile.TemporaryDirectory() as folder:  # here, where nothing crashes
        table = read_apart(answered, _packed(fmu, question, folder), str(path), allowed)
    return Answer(*(column.values for column in table.columns))


def _packed(fmu: Fmu, question: Question, folder: str) -> bytes:
    names = {
        "folder": folder,
        "places": [[place.position, place.rate, place.force] for place in fmu.places],
        "masses": [place.mass.value for place in fmu.places if place.mass is not None],
        "inputs": [variable for _, variable in fmu.inputs],
        "parameters": [variable for _, variable in fmu.parameters],
    }
    return packed(names, **question.arrays)


def answered(content: bytes, file: str) -> Table:
    """Let an FMU answer, in this process; the columns are the fields of an :class:`Answer`.

    Raises:
        InputError: as :func:`ask`.
    """
    names, arrays = unpacked(content)
    _require_small(file)
    try:
        answer = _answer(file, names, Question.of(arrays))
    except InputError:
        raise
    except Exception as error:  # a strange FMU makes FMPy raise errors of many kinds
        why = " ".join(str(error).split()) or type(error).__name__
        raise refusal(file, f"the FMU cannot be used: {why}") from error
    return answer.table(file)


def _require_small(file: str) -> None:
    try:
        with zipfile.ZipFile(file) as archive:
            size = sum(item.file_size for item in archive.infolist())
    except (OSError, zipfile.BadZipFile):
        raise refusal(file, "is no FMU: it is no ZIP archive") from None
    if size > FMU_UNPACKED:
        most = FMU_UNPACKED / 1e9
        raise refusal(file, f"unpacks to {size / 1e9:.1f} GB; an FMU has at most {most:g} GB")


class _Running(Protocol):
    """An FMU that is asked for the rates of its states."""

    def rates(self, t: float, x: Array, u: Array) -> Array:
        """x' (X,) at states x (X,) and inputs u (U,), in the units of the FMU."""


def _answer(file: str, names: dict[str, Any], question: Question) -> Answer:
    fmpy = needed("fmpy", "fmi", file)
    description = fmpy.read_model_description(file, validate=False)
    fmpy.extract(file, names["folder"])
    about = _About.of(description, names, file)
    first, folder = float(question.t[0]), names["folder"]
    parts = []
    for values in question.values:
        fmu = _started(description, folder, about, values, first, file)
        parts.append(_along(fmu, about, question, file))
    return Answer(*(np.stack(column) for column in zip(*parts, strict=True)))


@dataclass(frozen=True, slots=True)
class _About:
    """References of variables: ``inputs`` (those of the machine, then the forces), ``parameters``,
    ``states`` in the order of the FMU, with their derivatives ``rates``; ``order`` (2n,) are the
    positions and speeds of the coordinates among the states. ``masses`` (n,) stand in for forces
    where the FMU has none."""

    inputs: tuple[int, ...]
    parameters: tuple[int, ...]
    states: tuple[int, ...]
    rates: tuple[int, ...]
    order: tuple[int, ...]
    masses: tuple[float, ...] = ()

    @classmethod
    def of(cls, description: Any, names: dict[str, Any], file: str) -> "_About":
        """Find what is named.

        Raises:
            InputError: what is not there, or not what it is said to be.
        """
        known = {variable.name: variable for variable in description.modelVariables}
        made = [unknown.variable for unknown in description.derivatives]
        states = [_derived(variable, known) for variable in made]
        wanted = [name for place in names["places"] for name in place[:2]]
        forces = [place[2] for place in names["places"] if place[2]]
        faults = [
            *(
                f"does not say of which state '{variable.name}' is the derivative"
                for variable, state in zip(made, states, strict=True)
                if not state
            ),
            *(
                f"has no state '{name}'{did_you_mean(name, states)}"
                for name in wanted
                if name not in states
            ),
            *_not("input", [*forces, *names["inputs"]], known),
            *_not("parameter", names["parameters"], known),
        ]
        more = [name for name in states if name not in wanted]
        if more and not faults:
            faults.append(
                f"has states that are no position and no rate of a coordinate: {', '.join(more)}; "
                "only FMUs without other states can be used"
            )
        if faults:
            raise InputError([p for text in faults for p in refusal(file, text).problems])
        places, rates = wanted[::2], wanted[1::2]
        return cls(
            tuple(known[name].valueReference for name in [*names["inputs"], *forces]),
            tuple(known[name].valueReference for name in names["parameters"]),
            tuple(known[name].valueReference for name in states),
            tuple(variable.valueReference for variable in made),
            tuple(states.index(name) for name in [*places, *rates]),
            tuple(names["masses"]),
        )


def _derived(variable: Any, known: dict[str, Any]) -> str:
    """The state of which a variable is the derivative, empty where nothing says so: FMI has an
    attribute for it; where that is left out, der(NAME) is the name of a derivative (FMI 2.0,
    2.2.9)."""
    if variable.derivative is not None:
        return str(variable.derivative.name)
    inner = variable.name.removeprefix("der(").removesuffix(")")
    return inner if variable.name == f"der({inner})" and inner in known else ""


def _not(causality: str, names: Sequence[str], known: dict[str, Any]) -> Iterator[str]:
    fitting = [name for name, variable in known.items() if variable.causality == causality]
    for name in names:
        if name not in fitting:
            yield f"has no {causality} '{name}'{did_you_mean(name, fitting)}"


def _started(
    description: Any, folder: str, about: _About, values: Array, first: float, file: str
) -> _Running:
    """The FMU, unpacked in ``folder``, with parameters ``values`` (P,), ready to answer from the
    time ``first`` in s on."""
    which = "modelExchange" if description.modelExchange is not None else "coSimulation"
    kind = getattr(description, which)
    if kind is None:
        raise refusal(file, "is neither for model exchange nor for co-simulation")
    major = int(description.fmiVersion.partition(".")[0])
    if major not in (2, 3):
        raise refusal(file, f"is of FMI {description.fmiVersion}; FMI 2 and 3 are read")
    module = needed(f"fmpy.fmi{major}", "fmi", file)
    form = f"FMU{major}{'Model' if which == 'modelExchange' else 'Slave'}"
    fmu = getattr(module, form)(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=kind.modelIdentifier,
        instanceName="machine",
    )
    fmu.instantiate()
    calls = _Calls(fmu, major)
    if which == "coSimulation":
        restarted = _Restarted(calls, about, values)
        restarted.require_set(first, file)
        return restarted
    calls.set(about.parameters, values)
    calls.initialised(first, ())
    calls.settled()
    return _Exchanged(calls, about)


class _Calls:
    """The calls of FMI 2 and 3 that are needed, under one name each."""

    def __init__(self, fmu: Any, major: int):
        self.fmu, self.major = fmu, major

    def set(self, references: Sequence[int], values: Array) -> None:
        """Set numbers by reference."""
        if references:
            (self.fmu.setReal if self.major == 2 else self.fmu.setFloat64)(references, values)

    def get(self, references: Sequence[int]) -> list[float]:
        """Numbers by reference."""
        found = (self.fmu.getReal if self.major == 2 else self.fmu.getFloat64)(references)
        return list(found)

    def initialised(self, t: float, given: Sequence[tuple[Sequence[int], Array]]) -> None:
        """Go through initialisation at ``t``, s, with what is ``given`` by reference."""
        if self.major == 2:
            self.fmu.setupExperiment(startTime=t)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=t)
        for references, values in given:
            self.set(references, values)
        self.fmu.exitInitializationMode()

    def settled(self) -> None:
        """Let events happen until there are none, and let time run."""
        for _ in range(100):
            again = self.fmu.newDiscreteStates if self.major == 2 else self.fmu.updateDiscreteStates
            if not again()[0]:
                break
        self.fmu.enterContinuousTimeMode()


class _Exchanged:
    """An FMU for model exchange, in continuous time."""

    def __init__(self, calls: _Calls, about: _About):
        fmu, size = calls.fmu, len(about.states)
        self._fmu, self._size = fmu, size
        self._x, self._rates = (c_double * size)(), (c_double * size)()
        self._u = (c_double * len(about.inputs))()
        self._inputs = (c_uint32 * len(about.inputs))(*about.inputs)
        self._push: Any = fmu.fmi2SetReal if calls.major == 2 else fmu.fmi3SetFloat64
        self._more = () if calls.major == 2 else (len(about.inputs),)
        self._derive = fmu.getDerivatives if calls.major == 2 else fmu.getContinuousStateDerivatives

    def rates(self, t: float, x: Array, u: Array) -> Array:
        _fill(self._x, x)
        _fill(self._u, u)
        count = len(self._inputs)
        self._fmu.setTime(t)
        self._fmu.setContinuousStates(self._x, self._size)
        self._push(self._fmu.component, self._inputs, count, self._u, *self._more)
        self._derive(self._rates, self._size)
        return np.array(self._rates)


class _Restarted:
    """An FMU for co-simulation, begun anew at every state; its first rates are the answer."""

    def __init__(self, calls: _Calls, about: _About, values: Array):
        self._calls, self._about, self._values = calls, about, values

    def rates(self, t: float, x: Array, u: Array) -> Array:
        calls, about = self._calls, self._about
        calls.fmu.reset()
        calls.set(about.parameters, self._values)
        calls.set(about.states, x)
        calls.initialised(t, ((about.inputs, u),))
        return np.array(calls.get(about.rates))

    def require_set(self, t: float, file: str) -> None:
        """Refuse an FMU that begins elsewhere than at the states that are set."""
        wanted = np.linspace(0.1, 0.2, len(self._about.states))  # of no place at which one begins
        self.rates(t, wanted, np.zeros(len(self._about.inputs)))
        if np.abs(self._calls.get(self._about.states) - wanted).max() > EXACT:
            text = (
                "does not begin at the positions and rates that are set before it is initialised; "
                "ask its maker for model exchange"
            )
            raise refusal(file, text)


def _fill(buffer: "CArray[c_double]", values: Array) -> None:
    buffer[:] = values.tolist()


def _along(
    fmu: _Running, about: _About, question: Question, file: str
) -> tuple[Array, Array, Array]:
    """M (N, n, n), M·a_free (N, n) and M·∂a/∂(q, v, u) (N, n, 2n + k) along a motion."""
    q, n, k = question.q, question.q.shape[1], question.u.shape[1]
    mass, force = np.empty((q.shape[0], n, n)), np.empty((q.shape[0], n))
    slopes = np.empty((q.shape[0], n, 2 * n + k))
    places, speeds = list(about.order[:n]), list(about.order[n:])
    x, stated = np.zeros(2 * n), np.array(about.masses)

    def pulled(t: float, state: Array, push: Array) -> Array:
        """q'' (n,) at a state with inputs (2n + k,) under forces (n,)."""
        x[places], x[speeds] = state[:n], state[n : 2 * n]
        pushed = () if stated.size else push
        rates = fmu.rates(t, x, np.concatenate([state[2 * n :], pushed]))
        pull = rates[speeds] + (push / stated if stated.size else 0.0)
        if not np.isfinite(pull).all():
            raise refusal(file, f"the FMU gives an acceleration that is not finite at {t:g} s")
        moved = rates[places] - state[n : 2 * n]
        if np.abs(moved).max() > EXACT * max(float(np.abs(state[n : 2 * n]).max()), EXACT):
            text = "the derivative of a position is not the rate that is named beside it"
            raise refusal(file, f"{text}: look at [fmu.coordinates]")
        return pull

    probed = set(np.linspace(0, q.shape[0] - 1, PROBES).astype(int).tolist())
    for i, t in enumerate(question.t):
        state = np.concatenate([q[i], question.v[i], question.u[i]])
        free = pulled(t, state, np.zeros(n))
        ways = np.column_stack([pulled(t, state, PUSH * way) - free for way in np.eye(n)]) / PUSH
        mass[i] = _mass(ways, file)
        force[i] = mass[i] @ free
        push = mass[i] @ question.a[i] - force[i]
        if i in probed and np.any(push):
            _require_linear(pulled(t, state, push), question.a[i], free, file)
        for j, step in enumerate(question.steps):
            side = np.zeros(state.size)
            side[j] = step
            change = pulled(t, state + side, push) - pulled(t, state - side, push)
            slopes[i, :, j] = mass[i] @ change / (2 * step)
    return mass, force, slopes


def _mass(ways: Array, file: str) -> Array:
    """M (n, n) from the accelerations (n, n) under a unit force on each coordinate."""
    scale = np.sqrt(np.abs(np.diag(ways)))
    if np.all(scale > 0):
        balanced = ways / np.outer(scale, scale)
        even = np.abs(balanced - balanced.T).max() < np.sqrt(EXACT)
        balanced = (balanced + balanced.T) / 2
        if even and np.all(np.diag(ways) > 0) and np.linalg.eigvalsh(balanced)[0] > EXACT:
            return np.asarray(np.linalg.inv(balanced) / np.outer(scale, scale))
    text = (
        "the forces of [fmu.coordinates] do not act along their coordinates: the accelerations "
        f"under a unit force on each, {np.array2string(ways, precision=4)}, are no inverse of a "
        "mass matrix; name for each coordinate the input whose work is force times rate"
    )
    raise refusal(file, " ".join(text.split()))


def _require_linear(pull: Array, wanted: Array, free: Array, file: str) -> None:
    """A force must add in proportion to the accelerations."""
    change = max(float(np.abs(wanted - free).max()), EXACT)
    if np.abs(pull - wanted).max() > np.sqrt(EXACT) * change:
        text = "accelerations do not grow in proportion to the forces of [fmu.coordinates]"
        raise refusal(file, f"{text}; name inputs that act as forces alone")
