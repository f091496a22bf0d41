"""Event indicators: what jumps is in modes, an importer locates where they change, and the run is
that of located events."""

from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import Entries, model_of, oscillator
from fmus import FOUND, doubles, element, events_alone, get, loaded, machine, put, started, written
from numpy.typing import NDArray

from symhyb.errors import InputError
from symhyb.export.c_code import fmu_code
from symhyb.export.deliver import Order, deliver
from symhyb.export.description import model_description
from symhyb.export.fmu import fmu
from symhyb.export.spec import Spec, spec_of
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.modes import BAND_PLAY, NARROWEST, STOP_PLAY
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

END, BAND = 6.0, 1e-3  # s; m/s, what friction turns within
T = np.linspace(0, END, 601)
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
            "k": (40.0, "N/m"), "A": (0.8, "N"), "f": (0.3, "Hz"), "fc": (0.5, "N"),
            "vt": (band, "m/s"), "ks": (2e4, "N/m"), "ds": (30.0, "N*s/m"), "c": (0.04, "m"),
            "fs": (0.8, "N"), "vs": (0.01, "m/s"), "lean": (0.3, "1"),
        },
        start=0.1,
    )  # fmt: skip


def whole(model: Model) -> Spec:
    return spec_of(model, "swung", whole=True, events=True)


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
        str(path), fmi_type="ModelExchange", stop_time=END, output_interval=0.01, output=names,
        relative_tolerance=tolerance, record_events=True,
    )  # fmt: skip


def apart(run: NDArray[Any], told: Trajectory) -> tuple[float, float]:
    """The largest differences of place (m) and speed (m/s)."""
    rows = np.searchsorted(run["time"], T - 1e-9)
    q, v = run["q.x"][rows] - told.q[:, 0], run["v.x"][rows] - told.v[:, 0]
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
    told = read_model_description(str(path))
    assert told.numberOfEventIndicators == spec.exported.indicators > 0
    assert told.coSimulation is None
    assert told.modelExchange.needsCompletedIntegratorStep
    with loaded(path, fmi, "me") as instance:
        if fmi == 3:
            assert instance.getNumberOfEventIndicators() == spec.exported.indicators


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_run_with_located_events_is_the_exact_one_within_the_band(fmus, fmi: int) -> None:
    """It slides, turns, sticks and breaks away; what is off is the band alone."""
    model = swung(rub=RUB)
    told, run = exact(model), imported(fmus[fmi], whole(model))
    assert {event.transition for event in told.events} == {"slides +", "slides -", "sticks"}
    place, speed = apart(run, told)
    assert place < BAND  # m: the band's speed held for a second
    assert speed < 3 * BAND
    turns = [(float(b["time"]), b["mode.rub"]) for a, b in pairwise(run)
             if a["mode.rub"] != b["mode.rub"]]  # fmt: skip
    assert set(run["mode.rub"]) == {-1.0, 0.0, 1.0}
    signs = {"slides +": 1.0, "slides -": -1.0}
    slides = [event for event in told.events if event.transition in signs]
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
        ({"rub": {"kind": "friction", "between": ["wall", "block"], **{
            key: RUB[key] for key in ("coulomb", "transition")}}}, BAND),
    ],
    ids=["stop", "stops", "both", "stribeck", "between"],
)  # fmt: skip
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
        signs = [np.sign(b[f"event.rub.{s}"]) * np.sign(run[i][f"event.rub.{s}"])
                 for i, b in [(int(np.flatnonzero(run["time"] < before["time"])[-1]), after)]
                 for s in rising]  # fmt: skip
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

    run = simulate_fmu(str(path), fmi_type="ModelExchange", stop_time=END, output_interval=0.01,
                       output=["q.x", "v.x"], relative_tolerance=1e-8)  # fmt: skip
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

    def update(self) -> None:
        self.it.enterEventMode()
        settle = self.it.newDiscreteStates if self.fmi == 2 else self.it.updateDiscreteStates
        while settle()[0]:
            pass
        self.it.enterContinuousTimeMode()

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
            assert asked == crossed  # who does not watch is told
            if crossed:
                self.events.append(t)
                self.update()
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
        master.update()
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
        master.update()
        master.run(0.0, 0.8, 1e-3)
        assert np.array_equal(master.run(0.8, 2.5, 1e-3), once)
    place, speed = once[:2] - np.array([exact(swung(rub=RUB)).q[250, 0],
                                        exact(swung(rub=RUB)).v[250, 0]])  # fmt: skip
    assert abs(place) < BAND
    assert abs(speed) < 3 * BAND


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_mode_stays_until_event_mode_and_is_settled_at_the_start(
    fmi: int, tmp_path: Path
) -> None:
    spec = events_alone()
    at = {v.name: v.reference for v in spec.variables}
    asked = [at["dF.x"], at["mode.rub"]]
    path = written(tmp_path, spec, fmi)

    def force(v: float, sigma: float) -> float:
        return -0.5 * sigma - 0.4 * abs(v) * v

    with loaded(path, fmi, "me") as instance:
        if fmi == 2:
            instance.setupExperiment(startTime=0.0)
        instance.enterInitializationMode() if fmi == 2 else instance.enterInitializationMode(
            startTime=0.0
        )
        put(instance, fmi, [at["v.x"]], [-0.3])
        assert get(instance, fmi, asked) == pytest.approx([force(-0.3, -1), -1], rel=1e-14)
        instance.exitInitializationMode()
        assert get(instance, fmi, asked) == pytest.approx([force(-0.3, -1), -1], rel=1e-14)
        put(instance, fmi, [at["v.x"]], [5e-4])  # in event mode: at once
        assert get(instance, fmi, asked) == pytest.approx([force(5e-4, 0.5), 0], rel=1e-14)
        instance.enterContinuousTimeMode()
        put(instance, fmi, [at["v.x"]], [0.3])  # along the straight line, far beyond the band
        assert get(instance, fmi, asked) == pytest.approx([force(0.3, 300), 0], rel=1e-14)
        assert instance.completedIntegratorStep()[0]
        slope = instance.getDirectionalDerivative([at["dF.x"], at["event.rub.upper"]], [at["v.x"]],
                                                  [1.0])  # fmt: skip
        assert slope == pytest.approx([-0.5 / 1e-3 - 0.8 * 0.3, 1 / 1e-3], rel=1e-13)
        Master(instance, fmi, spec).update()
        assert get(instance, fmi, asked) == pytest.approx([force(0.3, 1), 1], rel=1e-14)
        assert not instance.completedIntegratorStep()[0]


def test_an_element_in_a_host_that_gives_its_speed_tells_where_it_turns(tmp_path: Path) -> None:
    """Speed cos(2π t): friction turns where it is ±1 mm/s."""
    from fmpy import simulate_fmu

    spec = spec_of(machine(), "rub", ("rub",), events=True)
    t = np.linspace(0, 1, 2001)
    signal = np.zeros(t.size, dtype=[("time", float), ("v.x", float)])
    signal["time"], signal["v.x"] = t, np.cos(2 * np.pi * t)
    run = simulate_fmu(
        str(written(tmp_path, spec, 2)), fmi_type="ModelExchange", stop_time=1.0, input=signal,
        output=["dF.x", "mode.rub"], output_interval=0.05, record_events=True,
    )  # fmt: skip
    turns = [float(b["time"]) for a, b in pairwise(run) if a["mode.rub"] != b["mode.rub"]]
    early = np.arccos(1e-3) / (2 * np.pi)
    assert turns == pytest.approx([early, 0.5 - early, 0.5 + early, 1 - early], abs=1e-6)
    assert set(run["mode.rub"]) == {-1, 0, 1}


def told(spec: Spec, u: list[float], **values: float) -> dict[str, float]:
    """Outputs and indicators by name, with modes and parameters set."""
    e = spec.exported
    names = [name for _, name in e.parameters]
    p = e.p.copy()
    for name, value in values.items():
        p[names.index(name)] = value
    y = e.evaluate(0.0, np.zeros(e.x.size), np.array(u, float), p)[1]
    return dict(zip([f"{kind}.{name}" for kind, name in e.outputs], y, strict=True))


def test_a_sign_in_a_law_is_a_mode_with_a_width_of_its_own() -> None:
    model = oscillator(
        {"dry": {"kind": "law", "on": "x", "force": "-fc*sign(x')"}}, {"fc": (2.0, "N")}
    )
    spec = spec_of(model, "dry", ("dry",), events=True)
    assert spec.exported.parameters == (("p", "fc"), ("p", "smoothing"), ("mode", "sign[1]"))
    mode = {"sign[1]": 1.0}
    assert told(spec, [-0.3], **mode)["dF.x"] == -2.0  # frozen
    here = told(spec, [4e-4])
    assert here == pytest.approx({"dF.x": -0.8, "event.sign[1].upper": 0.4 - 1 - BAND_PLAY,
                                  "event.sign[1].lower": 1.4 + BAND_PLAY}, rel=1e-14)  # fmt: skip
    sliding = told(spec, [4e-4], **mode)
    assert sliding["event.sign[1].upper"] == pytest.approx(0.4 - 1 + BAND_PLAY, rel=1e-14)
    narrow = told(spec, [1e-10], smoothing=0.0)
    assert narrow["dF.x"] == pytest.approx(-2 * 1e-10 / NARROWEST, rel=1e-14)


def test_friction_on_an_imposed_motion_switches_too() -> None:
    model = model_of(
        coordinates={"x": {"unit": "m", "imposed": True}},
        parameters={"fc": (2.0, "N"), "m": (1.0, "kg")},
        bodies={"one": {"mass": "m", "at": ["x", "0"]}},
        elements={"rub": {"kind": "friction", "on": "x", "coulomb": "fc"}},
    )
    spec = spec_of(model, "rub", ("rub",), events=True)
    assert told(spec, [5e-5])["dF.x"] == pytest.approx(-1.0)  # transition: 1e-4 m/s
    assert told(spec, [5e-5], rub=-1.0)["dF.x"] == 2.0


def test_a_stop_presses_while_it_touches_and_never_pulls() -> None:
    spec = spec_of(swung(stop={**STOP, "side": "upper"}), "stop", ("stop",), events=True)
    assert [name for _, name in spec.exported.parameters[-2:]] == ["stop", "stop.press"]
    at = [0.041, -0.1]  # 1 mm deep, leaving: 20 N − 3 N
    pressing = told(spec, at, **{"stop": 1.0, "stop.press": 1.0})
    assert pressing["dF.x"] == pytest.approx(-17.0)
    assert pressing["event.stop"] == pytest.approx(1e-3 + STOP_PLAY, rel=1e-12)
    assert pressing["event.stop.press"] > 0
    leaving = told(spec, [0.041, -1.0], **{"stop": 1.0, "stop.press": 1.0})
    assert leaving["event.stop.press"] < 0
    assert told(spec, at, **{"stop": 1.0, "stop.press": 0.0})["dF.x"] == 0.0
    apart_from_it = told(spec, [0.03, 5.0], **{"stop": 0.0, "stop.press": 1.0})
    assert apart_from_it["dF.x"] == 0.0
    assert apart_from_it["event.stop"] < 0 < apart_from_it["event.stop.press"]


def test_only_the_modes_of_what_is_exported_are_there() -> None:
    model = swung(rub=RUB, stop=STOP)
    assert [v.name for v in spec_of(model, "rub", ("rub",), events=True).of_role("mode")] == [
        "mode.rub"
    ]
    assert len(whole(model).of_role("mode")) == 5


@pytest.mark.parametrize("fmi", [2, 3])
def test_two_builds_are_the_same_and_without_events_there_is_no_trace_of_them(fmi: int) -> None:
    first, second = (fmu(events_alone(), fmi, platforms=("linux64",)) for _ in range(2))
    assert first == second
    plain = fmu_code(element(), fmi, "{it}") + model_description(element(), fmi, "", ("cs", "me"))
    for word in ("EVENTS", "N_M", "turned", "WAYS", "numberOfEventIndicators", "<EventIndicator"):
        assert word not in plain
    code = fmu_code(events_alone(), fmi, "{it}")
    assert "EVENTS" not in code
    assert "WAYS" in code


def test_what_cannot_have_events_is_refused_in_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nothing in what is exported switches.*--events"):
        spec_of(machine(), "drag", ("drag",), events=True)
    with pytest.raises(InputError, match=r"--kinds me"):
        fmu(events_alone(), kinds=("cs", "me"))
    for order, text in (
        (Order("c", FOUND, events=True), "--to fmu"),
        (Order("fmu", FOUND, kinds=("cs",), events=True), "--kinds me"),
    ):
        with pytest.raises(InputError, match=text):
            deliver(machine(), order, tmp_path / "a.fmu")
    assert list(tmp_path.iterdir()) == []


def test_co_simulation_of_it_cannot_be_begun(tmp_path: Path) -> None:
    for fmi in (2, 3):
        path = written(tmp_path, events_alone(), fmi)
        with pytest.raises(Exception, match=r"[Ii]nstantiate"), loaded(path, fmi, "cs"):
            pass


def test_the_command_says_what_is_watched(tmp_path: Path) -> None:
    order = Order("fmu", FOUND, platforms=("linux64",), events=True)
    lines = deliver(machine(), order, tmp_path / "rub.fmu")
    assert "FMI 2.0, me," in lines[0]
    assert "  event indicators: 2, of rub" in lines
