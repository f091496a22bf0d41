"""Laws in modes: what they say, when they change, what an FMU tells of them, what is refused."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import model_of, oscillator
from event_rigs import RUB, STOP, swung, updated, whole
from fmus import (
    FOUND,
    element,
    events_alone,
    get,
    loaded,
    machine,
    network,
    put,
    written,
)
from numpy.typing import NDArray

from symhyb.errors import InputError
from symhyb.export.c_code import fmu_code, samples
from symhyb.export.deliver import Order, deliver
from symhyb.export.description import model_description
from symhyb.export.fmu import fmu
from symhyb.export.functions.modes import BAND_PLAY, NARROWEST, STOP_PLAY
from symhyb.export.spec import Spec, spec_of
from symhyb.model.read import read_model

MODELS = Path(__file__).parents[2] / "models"
FAR = 20.0  # half widths from where a law turns: tanh is 1 there


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
        slope = instance.getDirectionalDerivative(
            [at["dF.x"], at["event.rub.upper"]], [at["v.x"]], [1.0]
        )
        assert slope == pytest.approx([-0.5 / 1e-3 - 0.8 * 0.3, 1 / 1e-3], rel=1e-13)
        updated(instance, fmi)
        assert get(instance, fmi, asked) == pytest.approx([force(0.3, 1), 1], rel=1e-14)
        assert not instance.completedIntegratorStep()[0]


def reported(spec: Spec, u: list[float], **values: float) -> dict[str, float]:
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
    assert reported(spec, [-0.3], **mode)["dF.x"] == -2.0  # frozen
    here = reported(spec, [4e-4])
    assert here == pytest.approx(
        {
            "dF.x": -0.8,
            "event.sign[1].upper": 0.4 - 1 - BAND_PLAY,
            "event.sign[1].lower": 1.4 + BAND_PLAY,
        },
        rel=1e-14,
    )
    sliding = reported(spec, [4e-4], **mode)
    assert sliding["event.sign[1].upper"] == pytest.approx(0.4 - 1 + BAND_PLAY, rel=1e-14)
    narrow = reported(spec, [1e-10], smoothing=0.0)
    assert narrow["dF.x"] == pytest.approx(-2 * 1e-10 / NARROWEST, rel=1e-14)


def test_friction_on_an_imposed_motion_switches_too() -> None:
    model = model_of(
        coordinates={"x": {"unit": "m", "imposed": True}},
        parameters={"fc": (2.0, "N"), "m": (1.0, "kg")},
        bodies={"one": {"mass": "m", "at": ["x", "0"]}},
        elements={"rub": {"kind": "friction", "on": "x", "coulomb": "fc"}},
    )
    spec = spec_of(model, "rub", ("rub",), events=True)
    assert reported(spec, [5e-5])["dF.x"] == pytest.approx(-1.0)  # transition: 1e-4 m/s
    assert reported(spec, [5e-5], rub=-1.0)["dF.x"] == 2.0


def test_a_stop_presses_while_it_touches_and_never_pulls() -> None:
    spec = spec_of(swung(stop={**STOP, "side": "upper"}), "stop", ("stop",), events=True)
    assert [name for _, name in spec.exported.parameters[-2:]] == ["stop", "stop.press"]
    at = [0.041, -0.1]  # 1 mm deep, leaving: 20 N − 3 N
    pressing = reported(spec, at, **{"stop": 1.0, "stop.press": 1.0})
    assert pressing["dF.x"] == pytest.approx(-17.0)
    assert pressing["event.stop"] == pytest.approx(1e-3 + STOP_PLAY, rel=1e-12)
    assert pressing["event.stop.press"] > 0
    leaving = reported(spec, [0.041, -1.0], **{"stop": 1.0, "stop.press": 1.0})
    assert leaving["event.stop.press"] < 0
    assert reported(spec, at, **{"stop": 1.0, "stop.press": 0.0})["dF.x"] == 0.0
    apart_from_it = reported(spec, [0.03, 5.0], **{"stop": 0.0, "stop.press": 1.0})
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


def settled(
    spec: Spec, t: float, x: NDArray[Any], u: NDArray[Any]
) -> tuple[NDArray[np.float64], list[float]]:
    """x' and y (no indicators) under the modes that belong to them, and where in their bands
    friction and signs are."""
    e, shares = spec.exported, list[float]()
    p = e.p.copy()
    for _ in range(len(e.ways) + 1):
        shares.clear()
        rates, y = e.evaluate(t, x, u, p)
        left = list(y[y.size - e.indicators :])
        for i, ways in enumerate(e.ways):
            upper, *lower = left[: ways - 1]
            left = left[ways - 1 :]
            shares += [upper + 1] if lower else []
            p[p.size - len(e.ways) + i] = 1 if upper > 0 else -1 if lower and lower[0] <= 0 else 0
    return np.concatenate([rates, y[: y.size - e.indicators]]), shares


@pytest.mark.parametrize("name", ["pendulum_on_cart", "quarter_car", "two_inertia_backlash"])
def test_away_from_the_bands_a_model_that_ships_is_what_it_is_without_events(name: str) -> None:
    model = read_model(MODELS / f"{name}.toml")
    spec, plain = (spec_of(model, "it", whole=True, events=events) for events in (True, False))
    assert spec.events
    (t, x, u), compared = samples(plain, 200, seed=29), 0
    for i in range(200):
        made, shares = settled(spec, t[i], x[i], u[i])
        if min(map(abs, shares), default=FAR) >= FAR:
            same = np.concatenate(plain.exported.evaluate(t[i], x[i], u[i], plain.exported.p))
            assert made == pytest.approx(same, rel=1e-9, abs=1e-9)
            compared += 1
    assert compared >= 50


def test_a_network_beside_friction_stays_what_it_is(tmp_path: Path) -> None:
    alone = network(tmp_path)
    model = alone.exported.model
    rub = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.2, "kg"), "w0": (1.0, "m"), "w1": (1.0, "m/s"), "fc": (0.7, "N")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={"rub": {"kind": "friction", "on": "x", "coulomb": "fc"}},
    )
    both = replace(rub, elements=(*model.elements, *rub.elements), file=model.file)
    for everything in (False, True):
        names = () if everything else ("rest", "rub")
        spec = spec_of(both, "both", names, everything, events=True)
        assert [v.name for v in spec.of_role("mode")] == ["mode.rub"]
    spec = spec_of(both, "both", ("rest", "rub"), events=True)
    for v in (-0.5, 0.5):
        u = [0.4, v]
        learnt = alone.exported.evaluate(0.0, np.zeros(0), np.array(u), alone.exported.p)[1][0]
        force = reported(spec, u, rub=np.sign(v))["dF.x"]
        assert force == pytest.approx(learnt - 0.7 * np.sign(v), rel=1e-13)
