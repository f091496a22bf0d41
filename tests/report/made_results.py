"""Results made by hand: what a diagnosis hands to the report, without any mechanics behind it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from symhyb.discrepancy.results import (
    Activity,
    Alternative,
    Change,
    Cloud,
    Comparison,
    Diagnosis,
    Estimate,
    Found,
    Measurement,
    Misfit,
    Occurrence,
    PlaceShare,
    Reestimated,
    Repeats,
    RivalRun,
    Score,
    Trace,
    Verdict,
)
from symhyb.discrepancy.words.wording import effect_sentence, verdict_sentence
from symhyb.model.types import Between, Element, On, Place

NAN, INFINITE = float("nan"), float("inf")
ALL_VERDICTS = ["missing", "null", "undecided", "parameters", "measurement", "failed", "hostile"]
HOSTILE = "<script>alert('x')</script>\"&$\\frac{$\x1b日本" + "very_long_name_" * 12


def found(name: str, kind: str, place: Place, law: str, share: float, *terms: Estimate) -> Found:
    element = Element(name, kind, place, ())
    return Found(element, law, terms, share, effect_sentence(kind, place, terms, share))


def score(size: float | None, scale: float = 1.0, sensor: str = "encoder", on: str = "q") -> Score:
    """A score of one sensor and one coordinate, ``size`` as a share of a range of ``scale`` m."""
    absolute = None if size is None else size * scale
    return Score(
        {on: size},
        {on: None if size is None else 3.0 * size},
        {sensor: size},
        {sensor: absolute},
        {sensor: None if size is None else 9.0 * size},
        {sensor: None if absolute is None else 9.0 * absolute},
    )


def trace(role: str, recording: str, samples: int = 8000, sensor: str = "encoder") -> Trace:
    """A slide that goes to and fro, in m; the model without friction drifts away."""
    t = np.linspace(0.0, 24.0, samples)
    true = 0.12 + 0.1 * np.tanh(6.0 * np.sin(2 * np.pi * t / 6.0)) * np.sin(0.3 * t + 0.4)
    noise = np.random.default_rng(1).normal(0.0, 4e-5, samples)
    before = true + 0.01 * (t / 24.0) ** 2 * np.cos(t)
    after = true + 4e-4 * np.sin(0.9 * t)
    return Trace(recording, role, t, {sensor: true + noise}, {sensor: before}, {sensor: after})  # type: ignore[arg-type]


def cloud(place: Place, samples: int = 8000) -> Cloud:
    t = np.linspace(0.0, 24.0, samples)
    rate = 0.12 * np.sin(2 * np.pi * t / 2.6) + 0.04 * np.sin(2 * np.pi * t / 1.1)
    stretch = 0.12 - 0.06 * np.cos(2 * np.pi * t / 2.6)
    law = -20.4 * np.tanh(rate / 5e-4) - 203.5 * rate + 3.16
    force = law + np.random.default_rng(2).normal(0.0, 2.5, samples) - 9.0 * (stretch - 0.12) / 0.06
    return Cloud(place, "DATA_EMPS.mat", t, stretch, rate, force, np.full(samples, 2.5), law)


def occurrence() -> Occurrence:
    t, lines = np.linspace(0.1, 23.9, 120), np.linspace(0.0, 5.0, 200)
    change = Change("DATA_EMPS.mat", 12.02, 0.2, "begins")
    before = np.where(t > 12.0, 40.0, 1.0)
    power = np.exp(-((lines - 2.0) ** 2))
    said = "On q, the mismatch begins at t = 12.02 s of DATA_EMPS.mat (to 0.2 s)."
    return Occurrence(change, (1.1, 2.9), None, t, before, np.ones(120), lines, power, said)


def rival(causes: str, size: float, recording: str = "DATA_EMPS.mat", **more: str) -> RivalRun:
    """A rival that differs at most by ``size`` standard deviations of the encoder's noise, at 6 s;
    no window covers the last two seconds."""
    t = np.linspace(0.0, 24.0, 4000)
    apart = 1.2e-5 * size * np.exp(-(((t - 6.0) / 4.0) ** 2)) * np.cos(2 * np.pi * (t - 6.0))
    sensor = more.get("sensor", "encoder")
    return RivalRun(
        causes,
        "viscous damping on q",
        3.2,
        0.1,
        recording,
        0.8,
        t,
        {sensor: np.where(t < 22.0, apart, NAN)},
        {sensor: 1.2e-5},
    )


def missing() -> tuple[Diagnosis, Verdict]:
    q = On("q")
    effects = (
        found(
            "found_friction",
            "friction",
            q,
            "coulomb*tanh(s'/transition)",
            0.871,
            Estimate("F_c", 20.41, 0.12, "N", "coulomb"),
            Estimate("v_t", 5.3e-4, 1.1e-4, "m/s", "transition"),
        ),
        found(
            "found_damper",
            "damper",
            q,
            "damping*s'",
            0.41,
            Estimate("b", 203.4, 1.34, "N*s/m", "damping"),
        ),
        found(
            "found_constant",
            "constant",
            q,
            "constant",
            0.012,
            Estimate("F_0", 3.16, 0.06, "N", "constant"),
        ),
    )
    active = Activity((0.02, 0.24), (-0.16, 0.16), ((0.4, 5.6), (6.4, 11.6)))
    diagnosis = Diagnosis(
        "missing physics",
        verdict_sentence("missing physics", effects),
        effects,
        alternatives=(
            Alternative(
                "found_constant",
                "offset",
                (Estimate("o", 3.16, 0.06, "N", "offset"),),
                0.0,
                channel="motor",
            ),
            Alternative(
                "found_damper",
                "drag",
                (Estimate("d", 1203.0, 22.0, "N*s^2/m^2", "drag"),),
                1540.2,
                place=q,
            ),
        ),
        record_next="Hold the slide still with the motor force at 0 N for five seconds: the "
        "constant then shows as a motion, an offset of the motor's channel does not.",
        remainder=0.0043,
        remainder_notes=("Friction is 4 % larger against positive q; left out: it earns 0.2 %.",),
        noise={"encoder": 0.0123, "tacho": 0.2},
        places=(
            PlaceShare(q, 0.9962, active, occurrence()),
            PlaceShare(Between("anchor", "tip"), 0.21, active),
        ),
        clouds=(cloud(q),),
        log=(
            "The noise of encoder is 0.0123 mm; the sensor's sd says 0.01 mm.",
            "ΔF is 41 times its band: something is missing.",
            "friction on q enters: Δχ² / c = 15300 on training windows, 9000 on held-out ones.",
        ),
        notes=("DATA_EMPS.mat: 12 samples of encoder are missing and were left out.",),
        misfits=(Misfit("c.csv", "Coulomb friction on q", 2.1, 0.1, 1.1, 0.1, "N", 1e-9, "c."),),
        repeats=(Repeats(("a.csv", "b.csv"), {"encoder": 0.01}, {"encoder": 0.02}, "Both."),),
    )
    verdict = Verdict(
        0.25,
        "fitted in every window, on unseen recordings too",
        60.0,
        Comparison(score(0.021, 0.21), score(0.0004, 0.21)),
        Comparison(score(0.024, 0.21), score(0.00052, 0.21)),
        "The errors over windows of 0.25 s carry the verdict: nothing holds q in place, so that "
        "errors of a free run add up.",
        (trace("train", "DATA_EMPS.mat"), trace("holdout", "DATA_EMPS_PULSES.mat")),
    )
    return diagnosis, verdict


def null() -> tuple[Diagnosis, Verdict]:
    _, verdict = missing()
    same = tuple(replace(old, before=old.after, failures=()) for old in verdict.traces[:1])
    comparison = Comparison(score(0.004), score(0.004))
    diagnosis = Diagnosis(
        "nothing missing",
        verdict_sentence("nothing missing"),
        remainder=1.0,
        noise={"encoder": 0.01},
        clouds=(replace(cloud(On("q"), 900), law=np.zeros(900)),),
    )
    return diagnosis, replace(verdict, train=comparison, holdout=None, traces=same)


def undecided() -> tuple[Diagnosis, Verdict]:
    rivals = (
        Alternative(
            None,
            "damper",
            (Estimate("b", 0.31, 0.02, "N*m*s/rad", "damping"),),
            0.0,
            place=On("phi"),
        ),
        Alternative(
            None, "delay", (Estimate("t", 0.0021, 0.0001, "s", "delay"),), 0.6, channel="tacho"
        ),
        Alternative(
            None, "parameter", (Estimate("k", 1012.0, 5.2, "N*m/rad", "k"),), 3.25, parameter="k"
        ),
    )
    _, verdict = missing()
    said = verdict_sentence("undecided", alternatives=rivals)
    runs = (rival("a delay in channel tacho", 1.4), rival("parameter k", -0.3))
    diagnosis = Diagnosis(
        "undecided", said, alternatives=rivals, record_next="A slower sine.", rivals=runs
    )
    return diagnosis, verdict


def parameters() -> tuple[Diagnosis, Verdict]:
    changed = (Reestimated("k", 980.0, 1012.3, 5.2, "N/m"),)
    said = verdict_sentence("parameters", parameters=changed)
    return Diagnosis("parameters", said, parameters=changed), missing()[1]


def measurement() -> tuple[Diagnosis, Verdict]:
    faults = (Measurement("encoder", "gain", 1.052, 0.0013, "1"),)
    said = verdict_sentence("measurement", measurement=faults)
    return Diagnosis("measurement", said, measurement=faults), missing()[1]


def failed() -> tuple[Diagnosis, Verdict]:
    """Scores that could not be computed and simulations that stopped."""
    diagnosis, verdict = missing()
    old = trace("holdout", "run.csv", 300)
    stopped = old.t > 12.0
    t, measured = old.t, old.measured["encoder"].copy()
    measured[40:90] = NAN
    before = np.where(stopped, NAN, old.before["encoder"] * np.exp(old.t))
    stopped_trace = Trace(
        "run.csv",
        "holdout",
        t,
        {"encoder": measured},
        {"encoder": before},
        {"encoder": np.full_like(t, NAN)},
        ("It stopped at 12 s: step size too small.",),
    )
    empty = np.empty(0)
    nothing = Trace(
        "empty.csv", "train", empty, {"encoder": empty}, {"encoder": empty}, {"encoder": empty}
    )
    unknown = replace(
        diagnosis,
        remainder=NAN,
        noise={"encoder": NAN},
        places=(PlaceShare(On("q"), None), PlaceShare(On("phi"), NAN)),
        clouds=(replace(cloud(On("q"), 200), force=np.full(200, NAN), band=np.full(200, NAN)),),
        found=tuple(
            replace(
                effect,
                share=None,
                estimates=tuple(replace(number, sd=INFINITE) for number in effect.estimates),
                active=Activity((NAN, INFINITE), (-0.1, 0.1), ()),
            )
            for effect in diagnosis.found
        ),
        alternatives=tuple(replace(rival, evidence=INFINITE) for rival in diagnosis.alternatives),
    )
    scores = Comparison(score(INFINITE), score(None))
    return unknown, replace(
        verdict,
        train=scores,
        holdout=Comparison(score(None), score(NAN)),
        force_band_hz=None,
        traces=(stopped_trace, nothing),
    )


def hostile() -> tuple[Diagnosis, Verdict]:
    """Names that try to become HTML, mathematics or control codes, and are far too long."""
    diagnosis, verdict = missing()
    place = Between(HOSTILE, "tip")
    effects = tuple(
        replace(
            effect,
            element=replace(effect.element, name=HOSTILE, place=place),
            law=HOSTILE,
            sentence=HOSTILE,
        )
        for effect in diagnosis.found
    )
    nasty = replace(
        diagnosis,
        sentence=HOSTILE,
        found=effects,
        record_next=HOSTILE,
        log=(HOSTILE,),
        notes=(HOSTILE,),
        remainder_notes=(HOSTILE,),
        noise={HOSTILE: 1.0},
        places=(PlaceShare(place, 0.5),),
        clouds=(replace(cloud(place, 400), recording=HOSTILE),),
        rivals=(rival(HOSTILE, 3.0, HOSTILE, sensor=HOSTILE),),
    )
    return nasty, replace(
        verdict,
        carries=HOSTILE,
        initial_states=HOSTILE,
        train=Comparison(score(0.1, sensor=HOSTILE, on=HOSTILE), score(0.01, sensor=HOSTILE)),
        traces=(replace(trace("train", HOSTILE, 500, HOSTILE), failures=(HOSTILE,)),),
    )


CASES: dict[str, Callable[[], tuple[Diagnosis, Verdict]]] = {
    "missing": missing,
    "null": null,
    "undecided": undecided,
    "parameters": parameters,
    "measurement": measurement,
    "failed": failed,
    "hostile": hostile,
}
