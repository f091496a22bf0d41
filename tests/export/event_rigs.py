"""What the tests of events share: a mass that slides, sticks and hits stops, and how an importer
that watches leaves an event."""

from typing import Any

from builders import Entries, oscillator

from symhyb.export.spec import Spec, spec_of
from symhyb.model.types import Model

BAND = 1e-3  # m/s, what friction turns within
RUB = {"kind": "friction", "on": "x", "coulomb": "fc", "transition": "vt"}
STOP = {"kind": "gap", "on": "x", "stiffness": "ks", "clearance": "c", "damping": "ds"}


def swung(band: float = BAND, **more: Entries) -> Model:
    """A mass on a spring, 0.1 m off, with a harmonic force and what else there is: it slides to and
    fro, sticks and breaks away."""
    return oscillator(
        {
            "spring": {"kind": "spring", "on": "x", "stiffness": "k"},
            "drive": {"kind": "harmonic", "on": "x", "amplitude": "A", "frequency": "f"},
            **more,
        },
        parameters={
            "k": (40.0, "N/m"),
            "A": (0.8, "N"),
            "f": (0.3, "Hz"),
            "fc": (0.5, "N"),
            "vt": (band, "m/s"),
            "ks": (2e4, "N/m"),
            "ds": (30.0, "N*s/m"),
            "c": (0.04, "m"),
            "fs": (0.8, "N"),
            "vs": (0.01, "m/s"),
            "lean": (0.3, "1"),
        },
        start=0.1,
    )


def whole(model: Model) -> Spec:
    return spec_of(model, "swung", whole=True, events=True)


def updated(instance: Any, fmi: int) -> None:
    """Through event mode and back."""
    instance.enterEventMode()
    settle = instance.newDiscreteStates if fmi == 2 else instance.updateDiscreteStates
    while settle()[0]:
        pass
    instance.enterContinuousTimeMode()
