"""What the tests of the export share: a correction with memory, a whole machine, and how to run an
FMU through FMPy."""

import ctypes
import hashlib
import json
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from builders import model_of, oscillator, push

from symhyb.export.fmu import fmu
from symhyb.export.spec import Spec, spec_of
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call

FOUND = ("rub", "drag", "relax")


def machine() -> Model:
    """A mass on a cubic spring with friction, drag and a Maxwell element, 0.1 m off its rest."""
    return oscillator(
        {
            "cubic": {"kind": "spring", "on": "x", "stiffness": "k", "cubic": "c"},
            "rub": {"kind": "friction", "on": "x", "coulomb": "fc", "transition": "vt"},
            "drag": {"kind": "drag", "on": "x", "drag": "b"},
            "relax": {"kind": "relaxation", "on": "x", "stiffness": "kr", "damping": "d"},
            "drive": push("f"),
        },
        parameters={
            "k": (40.0, "N/m"),
            "c": (200.0, "N/m^3"),
            "fc": (0.5, "N"),
            "vt": (1.0, "mm/s"),
            "b": (0.4, "N*s^2/m^2"),
            "kr": (20.0, "N/m"),
            "d": (3.0, "N*s/m"),
        },
        inputs={"f": {"unit": "N"}},
        start=0.1,
    )


@cache
def element() -> Spec:
    """The three laws that a diagnosis might have found, alone."""
    return spec_of(machine(), "correction", FOUND)


@cache
def whole() -> Spec:
    """The machine with all that acts on it."""
    return spec_of(machine(), "machine", whole=True)


@cache
def events_alone() -> Spec:
    """The three laws with their friction in modes."""
    return spec_of(machine(), "correction", FOUND, events=True)


@cache
def events_whole() -> Spec:
    """The machine with its friction in modes."""
    return spec_of(machine(), "machine", whole=True, events=True)


def network(folder: Path) -> Spec:
    """A network of place and speed with two layers of 64 units, trained to ±3 in both."""
    rng, layers = np.random.default_rng(0), []
    for wide, narrow, activation in ((2, 64, "tanh"), (64, 64, "tanh"), (64, 1, "identity")):
        weights = rng.normal(size=(narrow, wide)) / np.sqrt(wide)
        layer = {"weights": weights.tolist(), "bias": rng.normal(size=narrow).tolist()}
        layers.append({**layer, "activation": activation})
    text = json.dumps(
        {
            "symhyb-network": 1,
            "mean": [0, 0],
            "scale": [1, 1],
            "gain": 2.0,
            "offset": 0.1,
            "layers": layers,
        }
    )
    (folder / "net.json").write_text(text, encoding="utf-8")
    learnt = {
        "kind": "network",
        "on": "x",
        "weights": "net.json",
        "inputs": ["x/w0", "x'/w1"],
        "sha256": hashlib.sha256(text.encode()).hexdigest(),
        "trust": [[-3, 3], [-3, 3]],
    }
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.2, "kg"), "w0": (1.0, "m"), "w1": (1.0, "m/s")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={"rest": learnt},
    )
    return spec_of(replace(model, file=str(folder / "model.toml")), "net", ("rest",))


def written(folder: Path, spec: Spec, fmi: int, data: bytes | None = None) -> Path:
    """An FMU as a file."""
    path = folder / f"{spec.identifier}{fmi}.fmu"
    path.write_bytes(fmu(spec, fmi, platforms=("linux64",)) if data is None else data)
    return path


@contextmanager
def loaded(path: Path, fmi: int, kind: str = "cs") -> Iterator[Any]:
    """An instance of an FMU (FMPy), instantiated."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Model, FMU2Slave
    from fmpy.fmi3 import FMU3Model, FMU3Slave

    description = read_model_description(str(path))
    folder = extract(str(path), tempfile.mkdtemp(dir=path.parent))
    known = {(2, "cs"): FMU2Slave, (2, "me"): FMU2Model, (3, "cs"): FMU3Slave, (3, "me"): FMU3Model}
    instance = known[fmi, kind](
        guid=description.guid,
        unzipDirectory=folder,
        instanceName="it",
        modelIdentifier=description.modelName,
    )
    instance.instantiate()
    yield instance
    instance.freeInstance()


def started(instance: Any, fmi: int, **begin: float) -> Any:
    """Bring an instance to where it can be stepped or asked."""
    if fmi == 2:
        instance.setupExperiment(startTime=0.0, **begin)
        instance.enterInitializationMode()
    else:
        instance.enterInitializationMode(startTime=0.0, **begin)
    instance.exitInitializationMode()
    return instance


def put(instance: Any, fmi: int, references: list[int], values: list[float]) -> None:
    (instance.setReal if fmi == 2 else instance.setFloat64)(references, values)


def get(instance: Any, fmi: int, references: list[int]) -> list[float]:
    return list((instance.getReal if fmi == 2 else instance.getFloat64)(references))


def doubles(values: np.ndarray) -> Any:
    return (ctypes.c_double * values.size)(*values)


def places(spec: Spec) -> SimpleNamespace:
    """References by role."""
    roles = ("input", "output", "state", "rate", "parameter")
    return SimpleNamespace(**{r: [v.reference for v in spec.of_role(r)] for r in roles})


def jacobian(spec: Spec, t: float, x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """d(x', y)/d(t, x, u, p) by central differences of what CasADi evaluates."""
    e = spec.exported
    here = np.concatenate([[t], x, u, e.p])
    columns = []
    for i in range(here.size):
        ends = []
        step = 1e-6 * max(1.0, abs(here[i])) if i <= x.size + u.size else 1e-6 * abs(here[i])
        for sign in (1, -1):
            moved = here.copy()
            moved[i] += sign * step
            parts = np.split(moved, [1, 1 + x.size, 1 + x.size + u.size])
            ends.append(np.concatenate([a.reshape(-1) for a in call(e.value, parts)]))
        columns.append((ends[0] - ends[1]) / (2 * step))
    return np.array(columns).T
