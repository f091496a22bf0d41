"""Networks from recordings, one a coordinate, of forces or of rates.

A network of forces is trained and refined by simulation (:func:`train_network`). One of rates is
trained on Δv' = a − M⁻¹(k_e − k_c) of the windows that are not held; it is written as a network of
forces where M is constant and couples nothing, F = m Δv', and else stays a correction of rates.
Sizes: N samples, I inputs.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.correction.learning.corrected import Correction, Formulation, Networks
from symhyb.correction.learning.formulations import lacking, network_law
from symhyb.correction.learning.free_running import closer
from symhyb.correction.learning.matched import Signs, Worth, matched, worth
from symhyb.correction.learning.network import NAME, Trained, train_network
from symhyb.correction.search.preparing import Prepared, last_windows
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.recorded.ends import between_ends
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.mechanics.mass_text import mass_texts
from symhyb.model.expression import evaluate, names, parse_expression
from symhyb.model.types import Element, Model, Network, On
from symhyb.model.weights import keep
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.network import Weights, stored
from symhyb.steps import Counted, Say

ROWS_MOST = 6000  # samples that a network is trained on, evenly spread
NO_FILE = (
    "The rates cannot be written as a model file: a file holds forces, and the mass matrix that "
    "turns these rates into forces changes with the motion or couples coordinates. The network is "
    "simulated at the level of rates and stands in learned.json only."
)
ABOUT = "trained on what the model lacks: measured, but no physics known by name"


@dataclass(frozen=True, slots=True)
class Asked:
    """What is asked of networks: the coordinates they act ``on``, what each sees (empty: position
    and speed there), the hidden units of each of its ``members``, and the first ``seed``."""

    on: tuple[str, ...]
    inputs: tuple[str, ...]
    width: int
    members: int
    seed: int


@dataclass(frozen=True, slots=True, eq=False)
class One:
    """A trained network: the coordinate it acts ``on``, what it sees, its ``weights`` (of the force
    or the rate), ``trust`` box, SI, ``element`` (None: not in a file) and a sentence."""

    on: str
    inputs: tuple[str, ...]
    weights: Weights
    trust: tuple[tuple[float, float], ...]
    element: Element | None
    sentence: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Learnt:
    """Networks that are worth something, what held windows say of all of them together (None: not
    simulated), and the ``correction`` of rates where they are in no file."""

    networks: tuple[One, ...]
    worth: Worth | None
    correction: Correction | None = None
    notes: tuple[str, ...] = ()


def asked_coordinates(model: Model, on: Sequence[str]) -> tuple[str, ...]:
    """The free coordinates that are meant; all of them if none is named.

    Raises:
        InputError: a name that is no free coordinate.
    """
    free = tuple(c.name for c in model.coordinates if not c.imposed)
    if not free:
        raise InputError(Problem("no coordinate is free, so that nothing can be learned"))
    unknown = [name for name in on if name not in free]
    if unknown:
        raise InputError(
            Problem(f"'{name}' is no free coordinate{did_you_mean(name, free)}") for name in unknown
        )
    return tuple(dict.fromkeys(on)) or free


def learn_networks(
    model: Model,
    prepared: Prepared,
    recordings: Sequence[Recording],
    formulation: Formulation,
    asked: Asked,
    say: Say,
) -> Learnt:
    """Train networks of ΔF or of Δv' for what a ``model`` lacks.

    Raises:
        InputError: an input that does not exist or never changes, or a model with constraints whose
            rates are asked for.
        NumericsError: the model cannot be simulated along the recordings.
    """
    if formulation == "force":
        return _of_forces(model, prepared, recordings, asked, say)
    if prepared.machine.constraints:
        text = "a correction of rates is not offered with constraints; one of forces is"
        raise InputError(Problem(text, "constraints", model.file))
    say("training networks of rates")
    return _of_rates(model, prepared, asked)


def _of_forces(
    model: Model, prepared: Prepared, recordings: Sequence[Recording], asked: Asked, say: Say
) -> Learnt:
    found: list[One] = []
    corrected = model
    for done, on in enumerate(asked.on):
        say(Counted(f"training a network on {on}", done, len(asked.on)))
        one: Trained | None = train_network(
            corrected,
            recordings,
            on,
            inputs=asked.inputs,
            width=asked.width,
            members=asked.members,
            seed=asked.seed,
            name=_name(model, on, asked),
        )
        if one is None or one.element.network is None:
            continue
        corrected = one.model
        seen = tuple(item.text for item in one.element.network.inputs)
        trust = one.element.network.trust
        found.append(One(on, seen, one.weights, trust, one.element, one.sentence))
    say("simulating held windows")
    judged = _worth(prepared, [one.element for one in found if one.element])
    return Learnt(tuple(found) if judged.better else (), judged)


def _of_rates(model: Model, prepared: Prepared, asked: Asked) -> Learnt:
    machine = prepared.machine
    free = [machine.model.coordinates[i].name for i in machine.free]
    cuts = last_windows(prepared, spread=True)
    parts = [_rows(item, item.course(machine), ~item.held) for item in cuts]
    course, wanted = _joined(parts, [lacking(machine, part, "rates") for part in parts])
    first = len(free)
    for row, name in enumerate(free):
        wanted[:, row] = 0.0  # q' is v: position and speed are estimated together
        wanted[:, first + row] *= name in asked.on
    seen = asked.inputs or tuple(x for name in asked.on for x in (name, f"{name}'"))
    law = network_law(
        machine, course, wanted, seen, width=asked.width, members=asked.members, seed=asked.seed
    )
    rows = [(n, w) for n, w in zip(free, law.rows[first:], strict=True) if w is not None]
    masses = _constant_masses(model, {path for part in parts for path in part.known})
    if masses is None:
        better = closer(prepared, cuts, law)
        correction = Correction("rates", (law,)) if better else None
        ones = tuple(One(n, seen, w, law.trust, None) for n, w in rows) if better else ()
        return Learnt(ones, None, correction, (NO_FILE,) if better else ())
    ones = tuple(
        One(n, seen, w, law.trust, _element(model, n, w, masses[n], law, asked)) for n, w in rows
    )
    judged = _worth(prepared, [one.element for one in ones if one.element])
    return Learnt(ones if judged.better else (), judged)


def _element(
    model: Model, on: str, weights: Weights, mass: float, law: Networks, asked: Asked
) -> Element:
    """The network of the force m Δv'."""
    force = replace(weights, gain=mass * weights.gain, offset=mass * weights.offset)
    return network_element(_name(model, on, asked), on, force, law.inputs, law.trust)


def network_element(
    name: str,
    on: str,
    weights: Weights,
    inputs: Sequence[str],
    trust: Sequence[tuple[float, float]],
) -> Element:
    """Weights of a force on a coordinate as an element; they stay in memory until ``write_model``
    writes them beside a model file. ``inputs`` are expressions, ``trust`` the range of each, SI."""
    digest = keep(stored(weights))
    seen = tuple(parse_expression(text) for text in inputs)
    network = Network(f"{name}-{digest[:12]}.json", digest, seen, tuple(trust))
    return Element(name, "network", On(on), (), about=ABOUT, network=network)


def _name(model: Model, on: str, asked: Asked) -> str:
    """The name of a network's element, one that the model has not."""
    base = NAME if len(asked.on) == 1 else f"{NAME}_{on}"
    taken, name, count = {element.name for element in model.elements}, base, 2
    while name in taken:
        name, count = f"{base}_{count}", count + 1
    return name


def _worth(prepared: Prepared, elements: Sequence[Element]) -> Worth:
    """Held windows with nothing and with the elements."""
    none = Signs((), ())
    nothing = matched(prepared, (), none)
    if not elements:
        return worth(prepared, nothing, nothing)
    return worth(prepared, nothing, matched(prepared, elements, none))


def _constant_masses(model: Model, known: Collection[str]) -> dict[str, float] | None:
    """The mass of every coordinate, SI; None where M changes, couples coordinates, or is another in
    every recording, by a parameter that it knows."""
    texts = mass_texts(model)
    moving = {*(c.name for c in model.coordinates), *known}
    if texts is None or any(first != second for first, second in texts):
        return None
    values: dict[tuple[str, int] | str, NDArray[np.float64] | float] = {}
    values |= {p.name: p.si for p in model.parameters}
    masses = {}
    for (name, _), text in texts.items():
        expression = parse_expression(text)
        if any(one.name in moving for one in names(expression)):
            return None
        masses[name] = float(evaluate(expression, values, model.characteristics()))
    return masses


def _rows(item: Cut, course: Course, windows: NDArray[np.bool_]) -> Course:
    """The samples of some windows of a course, without the ends of the smoothed motion."""
    rows = item.rows[windows][:, :-1].ravel()  # the last of a window is the first of the next
    return course.at(rows[between_ends(item.source[1], course.t[rows])])


def _joined(parts: Sequence[Course], wanted: Sequence[Array]) -> tuple[Course, Array]:
    """One course after the other with what is ``wanted`` along each (N, R), thinned to what a
    network is trained on."""
    names = [item.name for item in fields(Course) if item.name != "known"]
    joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    whole = replace(parts[0], **joined, known={})
    thinly = slice(None, None, -(-whole.t.size // ROWS_MOST))
    return whole.at(thinly), np.concatenate(list(wanted))[thinly]
