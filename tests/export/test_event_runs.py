"""Event indicators in use: an importer locates where laws change, and the run is the exact one."""

from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import Entries
from event_rigs import BAND, RUB, STOP, swung, updated, whole
from fmus import (
    doubles,
    events_alone,
    loaded,
    machine,
    started,
    written,
)
from numpy.typing import NDArray

from symhyb.exact.simulation import simulate
from symhyb.export.functions.modes import BAND_PLAY
from symhyb.export.spec import Spec, spec_of
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import Trajectory
from symhyb.numeric.runs.scenario import Scenario

END = 6.0  # s
T = np.linspace(0, END, 601)


def exact(model: Model) -> Trajectory:
    """The run with located events."""
    scenario = Scenario(T, np.array([0.1]), np.zeros(1), T[[0, -1]], np.zeros((2, 0)))
    return simulate(build(model), scenario, exact=True)


def imported(path: Path, spec: Spec, tolerance: float = 1e-8) -> NDArray[Any]:
    """The run of an importer with CVODE that locates events: every output, before and after each
    event too."""
    from fmpy import simulate_fmu

    names = [v.name for role in ("state", "indicator", "mode") for v in spec.of_role(role)]
    return simulate_fmu(
        str(path),
        fmi_type="ModelExchange",
        stop_time=END,
        output_interval=0.01,
        output=names,
        relative_tolerance=tolerance,
        record_events=True,
    )


def apart(run: NDArray[Any], reported: Trajectory) -> tuple[float, float]:
    """The largest differences of place (m) and speed (m/s)."""
    rows = np.searchsorted(run["time"], T - 1e-9)
    q, v = run["q.x"][rows] - reported.q[:, 0], run["v.x"][rows] - reported.v[:, 0]
    return float(np.abs(q).max()), float(np.abs(v).max())


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Mapping[int, Path]:
    folder = tmp_path_factory.mktemp("events")
    return {fmi: written(folder, whole(swung(rub=RUB)), fmi) for fmi in (2, 3)}


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("made", [lambda: whole(swung(rub=RUB, stop=STOP)), events_alone])
def test_fmpy_finds_no_problem_and_counts_the_indicators(
    made: Callable[[], Spec], fmi: int, tmp_path: Path
) -> None:
    from fmpy import read_model_description
    from fmpy.validation import validate_fmu

    spec = made()
    path = written(tmp_path, spec, fmi)
    assert validate_fmu(str(path)) == []
    reported = read_model_description(str(path))
    assert reported.numberOfEventIndicators == spec.exported.indicators > 0
    assert reported.coSimulation is None
    assert reported.modelExchange.needsCompletedIntegratorStep
    with loaded(path, fmi, "me") as instance:
        if fmi == 3:
            assert instance.getNumberOfEventIndicators() == spec.exported.indicators


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_run_with_located_events_is_the_exact_one_within_the_band(fmus, fmi: int) -> None:
    """It slides, turns, sticks and breaks away; what is off is the band alone."""
    model = swung(rub=RUB)
    reported, run = exact(model), imported(fmus[fmi], whole(model))
    assert {event.transition for event in reported.events} == {"slides +", "slides -", "sticks"}
    place, speed = apart(run, reported)
    assert place < BAND  # m: the band's speed held for a second
    assert speed < 3 * BAND
    turns = [
        (float(b["time"]), b["mode.rub"])
        for a, b in pairwise(run)
        if a["mode.rub"] != b["mode.rub"]
    ]
    assert set(run["mode.rub"]) == {-1.0, 0.0, 1.0}
    signs = {"slides +": 1.0, "slides -": -1.0}
    slides = [event for event in reported.events if event.transition in signs]
    first, *found = [(t, mode) for t, mode in turns if mode != 0]
    assert first == (pytest.approx(0.0, abs=1e-3), -1.0)  # from rest
    assert [mode for _, mode in found] == [signs[event.transition] for event in slides]
    for (t, _), event in zip(found, slides, strict=True):
        assert t == pytest.approx(event.time, abs=0.02)  # through the band, and out of it


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_narrower_band_is_nearer_to_the_exact_run(fmi: int, tmp_path: Path) -> None:
    """In proportion, down to where the tolerance of the importer ends it."""
    off = []
    for band in (1e-2, 1e-3, 1e-4, 1e-5):
        model = swung(band, rub=RUB)
        run = imported(written(tmp_path, whole(model), fmi), whole(model))
        off.append(apart(run, exact(model))[0] / band)
    assert max(off) < 1.0
    assert max(off) < 2 * min(off)


@pytest.mark.parametrize(
    ("more", "bar"),
    [
        ({"stop": {**STOP, "side": "upper"}}, 1e-5),
        ({"stop": STOP}, 1e-5),
        ({"rub": RUB, "stop": STOP}, BAND),
        ({"rub": {**RUB, "static": "fs", "stribeck": "vs", "asymmetry": "lean"}}, 3 * BAND),
        (
            {
                "rub": {
                    "kind": "friction",
                    "between": ["wall", "block"],
                    **{key: RUB[key] for key in ("coulomb", "transition")},
                }
            },
            BAND,
        ),
    ],
    ids=["stop", "stops", "both", "stribeck", "between"],
)
def test_other_laws_that_switch_agree_too(more: Entries, bar: float, tmp_path: Path) -> None:
    model = swung(**more)  # type: ignore[arg-type]
    run = imported(written(tmp_path, whole(model), 2), whole(model))
    place, _ = apart(run, exact(model))
    assert place < bar


def test_every_event_is_where_an_indicator_changes_sign(fmus) -> None:
    """Before an event the mode is right or at its limit, behind it the indicators are beyond it."""
    run, band = imported(fmus[2], whole(swung(rub=RUB))), 1 + BAND_PLAY
    events = [(a, b) for a, b in pairwise(run) if a["mode.rub"] != b["mode.rub"]]
    assert len(events) >= 8
    for before, after in events:
        share = after["v.x"] / BAND
        assert before["time"] == pytest.approx(after["time"], abs=1e-9)
        assert min(abs(abs(share) - band), abs(abs(share) - 2 + band)) < 1e-6
        rising = {"upper": after["mode.rub"] == 1, "lower": after["mode.rub"] != -1}
        for side, positive in rising.items():
            assert (after[f"event.rub.{side}"] > 0) == positive
            assert after[f"event.rub.{side}"] != 0
        signs = [
            np.sign(b[f"event.rub.{s}"]) * np.sign(run[i][f"event.rub.{s}"])
            for i, b in [(int(np.flatnonzero(run["time"] < before["time"])[-1]), after)]
            for s in rising
        ]
        assert min(signs) == -1


def test_an_importer_that_does_not_watch_gets_it_wrong(fmus, tmp_path: Path) -> None:
    """The agreement above is that of events, not of luck."""
    import zipfile

    from symhyb.export.pack import archive

    with zipfile.ZipFile(fmus[2]) as packed:
        files = {name: packed.read(name) for name in packed.namelist()}
    text = files["modelDescription.xml"].decode()
    blind = text.replace('numberOfEventIndicators="2"', 'numberOfEventIndicators="0"').replace(
        "<ModelExchange ", '<ModelExchange completedIntegratorStepNotNeeded="true" '
    )
    assert blind.count("NotNeeded") == 1
    path = tmp_path / "blind.fmu"
    path.write_bytes(archive({**files, "modelDescription.xml": blind}))
    from fmpy import simulate_fmu

    run = simulate_fmu(
        str(path),
        fmi_type="ModelExchange",
        stop_time=END,
        output_interval=0.01,
        output=["q.x", "v.x"],
        relative_tolerance=1e-8,
    )
    assert apart(run, exact(swung(rub=RUB)))[0] > 20 * BAND


class Master:
    """An importer of our own: Runge–Kutta steps of order 4 and events located by bisection, through
    the calls of the standard."""

    def __init__(self, instance: Any, fmi: int, spec: Spec):
        self.it, self.fmi = instance, fmi
        self.x, self.z = np.zeros(len(spec.of_role("state"))), np.zeros(spec.exported.indicators)
        self.events: list[float] = []

    def state(self) -> NDArray[np.float64]:
        held = doubles(self.x)
        self.it.getContinuousStates(held, self.x.size)
        return np.array(held)

    def rates(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        made, form = (
            doubles(x),
            "getDerivatives" if self.fmi == 2 else "getContinuousStateDerivatives",
        )
        self.it.setTime(t)
        self.it.setContinuousStates(doubles(x), x.size)
        getattr(self.it, form)(made, x.size)
        return np.array(made)

    def indicators(self) -> NDArray[np.float64]:
        made = doubles(self.z)
        self.it.getEventIndicators(made, self.z.size)
        return np.array(made)

    def stepped(self, t: float, h: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        a = self.rates(t, x)
        b = self.rates(t + h / 2, x + h / 2 * a)
        c = self.rates(t + h / 2, x + h / 2 * b)
        made = x + h / 6 * (a + 2 * b + 2 * c + self.rates(t + h, x + h * c))
        self.it.setTime(t + h)
        self.it.setContinuousStates(doubles(made), made.size)
        return made

    def run(self, t: float, end: float, h: float) -> NDArray[np.float64]:
        """From t to ``end`` by steps of h, shorter before an event; the state there."""
        x = self.state()
        before = self.indicators() > 0
        while end - t > 1e-12:
            length = min(h, end - t)
            made = self.stepped(t, length, x)
            crossed = bool(np.any((self.indicators() > 0) != before))
            if crossed:
                low, high = 0.0, length
                while high - low > 1e-13:
                    middle = (low + high) / 2
                    self.stepped(t, middle, x)
                    if np.any((self.indicators() > 0) != before):
                        high = middle
                    else:
                        low = middle
                length = high
                made = self.stepped(t, length, x)
            t, x = t + length, made
            asked = self.it.completedIntegratorStep()[0]
            assert asked == crossed  # who does not watch is reported
            if crossed:
                self.events.append(t)
                updated(self.it, self.fmi)
                before = self.indicators() > 0
        return np.concatenate([x, self.indicators()])


@pytest.mark.parametrize("fmi", [2, 3])
def test_events_are_taken_again_from_a_saved_state_bit_by_bit(fmus, fmi: int) -> None:
    """Saved while it slides forwards; it turns, sticks and turns again, and once more."""
    spec, form = whole(swung(rub=RUB)), "FMUstate" if fmi == 2 else "FMUState"
    back = ("deSerialize" if fmi == 2 else "deserialize") + form
    with loaded(fmus[fmi], fmi, "me") as instance, loaded(fmus[fmi], fmi, "me") as other:
        started(instance, fmi)
        master = Master(instance, fmi, spec)
        updated(instance, fmi)
        master.run(0.0, 0.8, 1e-3)
        state = getattr(instance, f"get{form}")()
        stored = getattr(instance, f"serialize{form}")(state)
        master.events.clear()
        once, events = master.run(0.8, 2.5, 1e-3), list(master.events)
        assert len(events) >= 4
        getattr(instance, f"set{form}")(state)
        master.events.clear()
        assert np.array_equal(master.run(0.8, 2.5, 1e-3), once)
        assert master.events == events
        again = getattr(other, back)(stored)
        getattr(other, f"set{form}")(again)
        assert np.array_equal(Master(other, fmi, spec).run(0.8, 2.5, 1e-3), once)
        for held in (state, again):
            getattr(instance, f"free{form}")(held)
        instance.reset()
        started(instance, fmi)
        master = Master(instance, fmi, spec)
        updated(instance, fmi)
        master.run(0.0, 0.8, 1e-3)
        assert np.array_equal(master.run(0.8, 2.5, 1e-3), once)
    place, speed = once[:2] - np.array(
        [exact(swung(rub=RUB)).q[250, 0], exact(swung(rub=RUB)).v[250, 0]]
    )
    assert abs(place) < BAND
    assert abs(speed) < 3 * BAND


def test_an_element_in_a_host_that_gives_its_speed_tells_where_it_turns(tmp_path: Path) -> None:
    """Speed cos(2π t): friction turns where it is ±1 mm/s."""
    from fmpy import simulate_fmu

    spec = spec_of(machine(), "rub", ("rub",), events=True)
    t = np.linspace(0, 1, 2001)
    signal = np.zeros(t.size, dtype=[("time", float), ("v.x", float)])
    signal["time"], signal["v.x"] = t, np.cos(2 * np.pi * t)
    run = simulate_fmu(
        str(written(tmp_path, spec, 2)),
        fmi_type="ModelExchange",
        stop_time=1.0,
        input=signal,
        output=["dF.x", "mode.rub"],
        output_interval=0.05,
        record_events=True,
    )
    turns = [float(b["time"]) for a, b in pairwise(run) if a["mode.rub"] != b["mode.rub"]]
    early = np.arccos(1e-3) / (2 * np.pi)
    assert turns == pytest.approx([early, 0.5 - early, 0.5 + early, 1 - early], abs=1e-6)
    assert set(run["mode.rub"]) == {-1, 0, 1}
