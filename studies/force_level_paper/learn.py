"""What is learned from a recording: four corrections, each at the level of forces and of rates.

    default    the paper's tool: one layer of 10 rectified units, L-BFGS, nothing standardised
    chosen     symhyb's: tanh, standardised, stopped early, three members, refined (train_network)
    sparse     symhyb's diagnosis: named laws; of rates, PySINDy's STLSQ on a library
    combined   the sparse one, and a network of what it leaves

The samples that are not trained on are no part of the recording that symhyb is given.
"""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPRegressor
from threadpoolctl import threadpool_limits
from truth import Array, Data, Drive, Oscillator

import symhyb as sh
from symhyb.learning import (
    Correction,
    Course,
    Formulation,
    Law,
    Networks,
    Terms,
    Weights,
    course_of,
    lacking,
    lowered,
    measured_course,
    network_element,
    network_law,
    sparse_law,
    values_along,
)
from symhyb.model.read import parse_model
from symhyb.model.types import Element
from symhyb.model.write import append_elements

ROWS = ("default", "chosen", "sparse", "combined")
REGRESSION = "regression"  # of forces, by what "sparse" uses for rates
SEEN = ("q", "q'")
FAR = 1e6  # SI: the default network goes on wherever it is asked
LIBRARY = ("q", "q'", "q**2", "q*q'", "abs(q')*q'", "q**3", "q'**3", "tanh(q'/0.001)", "1")
THRESHOLD = 0.05

TEXT = """symhyb = 1
title = "Mass on a cubic spring"
[coordinates]
q = {{ unit = "m", start = {q0!r} }}
[parameters]
m = {{ value = {m!r}, unit = "kg" }}
c = {{ value = {c!r}, unit = "N/m^3" }}
F = {{ value = {amplitude!r}, unit = "N" }}
{frequency}
[bodies.mass]
mass = "m"
at = ["q", "0"]
[elements.spring]
kind = "spring"
on = "q"
cubic = "c"
[elements.drive]
{drive}
on = "q"
[sensors]
{sensors}
"""


def model_of(it: Oscillator, drive: Drive, data: Data, only_place: bool = False) -> sh.Model:
    """The model file: mass, cubic spring and drive, without drag and friction."""
    read = (("place", "q", "m"), ("tacho", "q'", "m/s"), ("pull", "q''", "m/s^2"))
    lines = [
        f'{name} = {{ measures = "{what}", unit = "{unit}", sd = {float(sd)!r} }}'
        for (name, what, unit), sd in zip(read, data.sd[:, 0], strict=True)
    ]
    frequency, kind = "", 'kind = "constant"\nconstant = "F"'
    if drive.frequency:
        frequency = f'f = {{ value = {drive.frequency!r}, unit = "Hz" }}'
        kind = 'kind = "harmonic"\namplitude = "F"\nfrequency = "f"'
    return parse_model(
        TEXT.format(
            q0=it.q0,
            m=it.m,
            c=it.c,
            amplitude=drive.amplitude,
            frequency=frequency,
            drive=kind,
            sensors="\n".join(lines[:1] if only_place else lines),
        )
    )


def recording_of(data: Data, only_place: bool = False) -> sh.Recording:
    """What is measured, without the samples that are kept back."""
    columns = {"place": data.q, "tacho": data.v, "pull": data.a}
    sensors = {
        name: column[data.train, 0]
        for name, column in columns.items()
        if name == "place" or not only_place
    }
    return sh.Recording("recording", data.t[data.train], {}, sensors, (), "")


@dataclass(frozen=True, slots=True)
class Learned:
    """A correction of forces as ``elements`` of a model, one of rates as a ``correction`` (that of
    ``REGRESSION`` is of forces), and a sentence on what was learned."""

    elements: tuple[Element, ...]
    correction: Correction | None
    said: str

    def on(self, model: sh.Model) -> sh.Model:
        """A model with the elements."""
        return append_elements(model, list(self.elements)) if self.elements else model


def learn(it: Oscillator, data: Data, seed: int, only_place: bool = False) -> Mapping[str, Learned]:
    """All corrections from the recording of an oscillator under its drive; where ``only_place`` is
    measured, only the default network and the sparse ones."""
    model = model_of(it, it.drive, data, only_place)
    return learn_model(model, data, seed, only_place)


def learn_model(
    model: sh.Model, data: Data, seed: int, only_place: bool = False
) -> Mapping[str, Learned]:
    machine, recording = sh.build(model), recording_of(data, only_place)
    rows = np.flatnonzero(data.train)
    if only_place:
        smooth = sh.compare(machine, recording).motion
        course = course_of(recording, machine, smooth)
    else:
        motion = (data.q[rows], data.v[rows], data.a[rows])
        course = measured_course(machine, data.t[rows], motion, np.empty((rows.size, 0)))
    diagnosis = sh.diagnose(model, recording)
    found = tuple(item.element for item in diagnosis.found)
    corrected = append_elements(model, list(found)) if found else model
    chosen = None if only_place else sh.train_network(model, recording, seed=seed)
    rest = None
    if found and not only_place:
        rest = sh.train_network(corrected, recording, seed=seed)
    forces = {
        "default": (default_element(default_networks(machine, course, "force", seed)),),
        "chosen": () if chosen is None else (chosen.element,),
        "sparse": found,
        "combined": (*found, *(() if rest is None else (rest.element,))),
    }
    if only_place:
        terms = sparse_law(machine, course, lacking(machine, course, "rates"), LIBRARY, THRESHOLD)
        sparse = Learned(found, Correction("rates", (terms,)), diagnosis.sentence)
        return {"default": Learned(forces["default"], None, ""), "sparse": sparse}
    rates = _of_rates(machine, course, seed)
    regression = sparse_law(machine, course, lacking(machine, course, "force"), LIBRARY, THRESHOLD)
    said = {
        "default": "",
        "chosen": "" if chosen is None else chosen.sentence,
        "sparse": diagnosis.sentence,
        "combined": "" if rest is None else rest.sentence,
    }
    learned = {name: Learned(forces[name], rates[name], said[name]) for name in ROWS}
    plain = Correction("force", (regression,))
    return {**learned, REGRESSION: Learned((), plain, said_of(regression))}


def said_of(terms: Terms, row: int = -1) -> str:
    """A row of terms as a formula in SI."""
    pairs = zip(terms.coefficients[row], terms.texts, strict=True)
    return " ".join(f"{value:+.3g}·{text}" for value, text in pairs if value) or "0"


def _of_rates(machine: sh.Machine, course: Course, seed: int) -> dict[str, Correction]:
    wanted = lacking(machine, course, "rates")
    terms = sparse_law(machine, course, wanted, LIBRARY, THRESHOLD)
    left = wanted - values_along(machine, course, terms)
    left[:, 0] = 0.0
    laws: dict[str, tuple[Law, ...]] = {
        "default": (default_networks(machine, course, "rates", seed),),
        "chosen": (network_law(machine, course, wanted, SEEN, seed=seed),),
        "sparse": (terms,),
        "combined": (terms, network_law(machine, course, left, SEEN, seed=seed)),
    }
    return {name: Correction("rates", law) for name, law in laws.items()}


def default_networks(
    machine: sh.Machine, course: Course, formulation: Formulation, seed: int
) -> Networks:
    """What the default of MATLAB's fitrnet does, a network a row: one layer of 10 rectified units,
    no penalty, L-BFGS up to 1000 iterations, tolerance 1e-6, raw q and q'. None for a row of
    zeros."""
    wanted = lacking(machine, course, formulation)
    seen = np.column_stack([course.q, course.v])
    rows = [_default(seen, column, seed) if column.any() else None for column in wanted.T]
    names = [c.name for c in machine.model.coordinates]
    trust = ((-FAR, FAR),) * seen.shape[1]
    return Networks((*names, *(f"{name}'" for name in names)), tuple(rows), trust)


def _default(seen: Array, wanted: Array, seed: int) -> Weights:
    mlp = MLPRegressor(
        hidden_layer_sizes=(10,),
        activation="relu",
        solver="lbfgs",
        alpha=0.0,
        max_iter=1000,
        tol=1e-6,
        max_fun=50_000,
        random_state=seed,
    )
    with warnings.catch_warnings(), threadpool_limits(1):
        warnings.simplefilter("ignore", ConvergenceWarning)  # the default has its limit, too
        mlp.fit(seen, wanted)
    count = seen.shape[1]
    return lowered(mlp, np.zeros(count), np.ones(count), 1.0, 0.0)


def default_element(networks: Networks, row: int = 0, on: str = "q") -> Element:
    """One row of networks of forces as an element."""
    weights = networks.rows[row]
    assert weights is not None
    return network_element(f"default_{on}", on, weights, networks.inputs, networks.trust)


def force_of(model: sh.Model, corrected: sh.Model, motion: tuple[Array, Array, Array]) -> Array:
    """ΔF (N, n) of a correction along a motion, SI: what it takes off the force that lacks."""
    t = np.arange(len(motion[0])) * 1.0
    no = np.empty((t.size, 0))
    parts = []
    for one in (model, corrected):
        machine = sh.build(one)
        parts.append(lacking(machine, measured_course(machine, t, motion, no), "force"))
    return parts[0] - parts[1]
