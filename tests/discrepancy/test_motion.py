"""Motion from noisy sensors: close to the truth, and the bands say how close."""

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from builders import Entries, model_of, oscillator, push, recording
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import (
    acting,
    measured,
    motion_of,
    noise_level,
    spline_basis,
)
from symhyb.errors import InputError
from symhyb.model.read import read_model
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.running import simulate

Array = NDArray[np.float64]
MODELS = Path(__file__).parents[2] / "models"

PLACE = {"measures": "x", "unit": "m"}
SPEED = {"measures": "x'", "unit": "m/s"}
PULL = {"measures": "x''", "unit": "m/s^2"}


def machine(**sensors: Entries) -> Machine:
    return build(oscillator({}, sensors=sensors))


def sines(t: Array) -> tuple[Array, Array, Array]:
    """Place, speed and acceleration of two sines, 0.7 and 1.6 Hz."""
    parts = ((0.03, 2 * np.pi * 0.7, 0.2), (0.01, 2 * np.pi * 1.6, 1.1))
    x = sum(a * np.sin(w * t + p) for a, w, p in parts)
    v = sum(a * w * np.cos(w * t + p) for a, w, p in parts)
    return (
        np.asarray(x),
        np.asarray(v),
        np.asarray(-sum(a * w**2 * np.sin(w * t + p) for a, w, p in parts)),
    )


def noisy(values: Array, sd: float, seed: int) -> Array:
    return values + sd * np.random.default_rng(seed).normal(size=values.size)


EVEN = np.arange(1500) / 150
UNEVEN = np.sort(np.random.default_rng(1).uniform(0, 10, 1500))
INSIDE = slice(75, -75)  # a spline is less certain at its ends, and the bands are those inside


def with_holes(values: Array) -> Array:
    holed = values.copy()
    holed[np.random.default_rng(2).random(values.size) < 0.2] = np.nan
    holed[700:712] = np.nan
    return holed


CASES: Mapping[str, tuple[Array, dict[str, Entries], Callable[[int], dict[str, Array]]]] = {
    "position": (EVEN, {"p": PLACE}, lambda s: {"p": noisy(sines(EVEN)[0], 3e-4, s)}),
    "missing samples": (
        EVEN,
        {"p": PLACE},
        lambda s: {"p": with_holes(noisy(sines(EVEN)[0], 3e-4, s))},
    ),
    "uneven samples": (UNEVEN, {"p": PLACE}, lambda s: {"p": noisy(sines(UNEVEN)[0], 3e-4, s)}),
    "position and speed": (
        EVEN,
        {"p": PLACE, "v": SPEED},
        lambda s: {"p": noisy(sines(EVEN)[0], 3e-4, s), "v": noisy(sines(EVEN)[1], 3e-3, s + 50)},
    ),
    "all three": (
        EVEN,
        {"p": PLACE, "v": SPEED, "a": PULL},
        lambda s: {
            "p": noisy(sines(EVEN)[0], 3e-4, s),
            "v": noisy(sines(EVEN)[1], 3e-3, s + 50),
            "a": noisy(sines(EVEN)[2], 3e-2, s + 90),
        },
    ),
}


@cache
def coverage(case: str) -> tuple[Array, Array]:
    """Share of samples within two standard deviations, and RMS error over sd, of q, q' and q''."""
    t, sensors, data = CASES[case]
    rig = machine(**sensors)
    inside, sizes = [], []
    for seed in range(3):
        motion = motion_of(recording(t, **data(seed)), rig)
        found = np.array([motion.q, motion.v, motion.a])[:, INSIDE, 0]
        sd = np.concatenate([motion.q_sd, motion.v_sd, motion.a_sd])[:, None]
        miss = np.abs(found - np.array(sines(t))[:, INSIDE]) / sd
        inside.append(np.mean(miss < 2, axis=1))
        sizes.append(np.sqrt(np.mean(miss**2, axis=1)))
    return np.mean(inside, axis=0), np.mean(sizes, axis=0)


@pytest.mark.parametrize("case", CASES)
def test_place_and_speed_lie_within_their_bands(case: str) -> None:
    """Two standard deviations hold at least 80 % of the samples, and are not far too wide."""
    inside, size = coverage(case)
    assert inside[:2].min() > 0.8
    assert size[:2].min() > 0.5


@pytest.mark.parametrize("case", CASES)
def test_accelerations_lie_within_their_bands(case: str) -> None:
    inside, size = coverage(case)
    assert inside[2] > 0.8
    assert size[2] > 0.5


def test_the_error_is_far_below_that_of_differences() -> None:
    """Noise of 1 % of the amplitude, 150 samples a second: second differences are all noise."""
    place = noisy(sines(EVEN)[0], 3e-4, 7)
    motion = motion_of(recording(EVEN, p=place), machine(p=PLACE))
    limits = (0.01, 0.02, 0.08)
    for truth, found, limit in zip(
        sines(EVEN), (motion.q, motion.v, motion.a), limits, strict=True
    ):
        error = found[INSIDE, 0] - truth[INSIDE]
        assert np.sqrt(np.mean(error**2)) < limit * np.sqrt(np.mean(truth**2))
    differences = np.gradient(np.gradient(place, EVEN), EVEN)
    assert np.std(differences - sines(EVEN)[2]) > 4 * np.std(sines(EVEN)[2])
    assert motion.sd == pytest.approx([3e-4], rel=0.1)
    assert motion.spacing_s > 8 / 150


def test_a_second_sensor_narrows_the_band() -> None:
    one, both = (
        motion_of(recording(EVEN, **CASES[case][2](3)), machine(**CASES[case][1]))
        for case in ("position", "position and speed")
    )
    assert both.v_sd[0] < 0.8 * one.v_sd[0]
    assert both.sd == pytest.approx([3e-4, 3e-3], rel=0.1)


def test_acceleration_alone_gives_speed_and_place_up_to_what_it_cannot_see() -> None:
    """x + c1 + c2 t has the same acceleration; the rest is recovered."""
    motion = motion_of(recording(EVEN, a=noisy(sines(EVEN)[2], 0.02, 4)), machine(a=PULL))
    x, _, a = sines(EVEN)
    assert motion.a[INSIDE, 0] == pytest.approx(a[INSIDE], abs=6 * motion.a_sd[0])
    miss = motion.q[:, 0] - x
    drift = np.polynomial.Polynomial.fit(EVEN, miss, 1)(EVEN)
    assert np.std(miss - drift) < 0.1 * np.std(x)


def test_a_nonlinear_sensor_is_inverted() -> None:
    """The height of a pendulum's tip: l (1 − cos phi), swinging on one side of the vertical."""
    model = model_of(
        coordinates={"phi": {"unit": "rad", "start": 1.0}},
        parameters={"m": (0.4, "kg"), "l": (0.3, "m")},
        bodies={"bob": {"mass": "m", "at": ["l*sin(phi)", "-l*cos(phi)"]}},
        sensors={"height": {"measures": "l*(1 - cos(phi))", "unit": "mm"}},
    )
    phi = 1.2 + 0.4 * np.sin(2 * np.pi * 0.5 * EVEN)
    height = noisy(0.3 * (1 - np.cos(phi)), 3e-4, 5)
    motion = motion_of(recording(EVEN, height=height), build(model))
    assert motion.q[INSIDE, 0] == pytest.approx(phi[INSIDE], abs=6 * motion.q_sd[0])
    assert motion.q_sd[0] < 1e-3
    assert motion.sd == pytest.approx([3e-4], rel=0.1)


def two_coordinates() -> tuple[Machine, dict[str, Array], Array]:
    """Sum and difference of two motions, with noise; the truth (2, N)."""
    model = model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={"m": (1.0, "kg")},
        bodies={"one": {"mass": "m", "at": ["x", "0"]}, "two": {"mass": "m", "at": ["y", "0"]}},
        sensors={
            "sum": {"measures": "x + y", "unit": "m"},
            "gap": {"measures": "x - y", "unit": "m"},
        },
    )
    x, y = np.sin(3 * EVEN), 0.5 * np.cos(5 * EVEN)
    data = {"sum": noisy(x + y, 2e-3, 1), "gap": noisy(x - y, 2e-3, 2)}
    return build(model), data, np.array([x, y])


def test_two_coordinates_from_two_sensors_that_mix_them() -> None:
    rig, data, truth = two_coordinates()
    motion = motion_of(recording(EVEN, **data), rig)
    assert np.sqrt(np.mean((motion.q.T - truth) ** 2, axis=1)).max() < 1e-3
    assert motion.sd == pytest.approx([2e-3, 2e-3], rel=0.1)


def test_two_coordinates_lie_within_their_bands() -> None:
    rig, data, truth = two_coordinates()
    motion = motion_of(recording(EVEN, **data), rig)
    miss = np.abs(motion.q.T - truth)[:, INSIDE] / motion.q_sd[:, None]
    assert np.mean(miss < 2, axis=1).min() > 0.8


def test_a_recording_without_noise_is_followed_to_the_end() -> None:
    motion = motion_of(recording(EVEN, p=sines(EVEN)[0]), machine(p=PLACE))
    assert motion.q[:, 0] == pytest.approx(sines(EVEN)[0], abs=1e-7)
    assert motion.a[INSIDE, 0] == pytest.approx(sines(EVEN)[2][INSIDE], abs=1e-3)


def test_periods_are_those_of_what_moves() -> None:
    motion = motion_of(recording(EVEN, p=0.02 * np.sin(2 * np.pi * 0.8 * EVEN)), machine(p=PLACE))
    assert motion.periods() == pytest.approx([1.25], rel=0.05)


def test_every_takes_the_middle_of_each_block() -> None:
    motion = motion_of(recording(EVEN, p=sines(EVEN)[0]), machine(p=PLACE))
    thin = motion.every(4)
    assert thin.t == pytest.approx(EVEN[2::4])
    assert thin.q[:, 0] == pytest.approx(motion.q[2::4, 0])


def test_a_recording_without_any_sensor_is_refused() -> None:
    with pytest.raises(InputError, match=r"test\.csv: sensors: none of the model's sensors"):
        motion_of(recording(EVEN), machine(p=PLACE))


def chain(t: Array) -> tuple[Machine, Array]:
    """Two masses on springs between a wall and each other, swinging freely, and their places."""
    model = model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "k": (90.0, "N/m")},
        points={"a": ["x", "0"], "b": ["y", "0"]},
        bodies={"one": {"mass": "m", "at": "a"}, "two": {"mass": "m", "at": "b"}},
        energy={"potential": "k*x**2/2 + k*(y - x)**2/2"},
        sensors={
            "place": {"measures": "y", "unit": "m"},
            "pull": {"measures": "y''", "unit": "m/s^2"},
        },
    )
    stiffness = np.array([[180.0, -90.0], [-90.0, 90.0]])
    power, shape = np.linalg.eigh(stiffness)
    first = shape.T @ np.array([0.02, -0.01])
    return build(model), (np.cos(np.outer(t, np.sqrt(power))) * first) @ shape.T


@pytest.mark.parametrize("sensor", ["place", "pull"])
def test_the_model_tells_what_no_sensor_shows(sensor: str) -> None:
    """The first mass has no sensor at all; from acceleration alone no place is shown."""
    t = np.linspace(0, 12, 1500)
    swinging, q = chain(t)
    shown = q[:, 1] if sensor == "place" else 90.0 * (q[:, 0] - q[:, 1])
    noise = 1e-2 * np.std(shown)
    motion = motion_of(recording(t, **{sensor: noisy(shown, noise, 7)}), swinging)
    assert motion.blind == (("x",) if sensor == "place" else ("x", "y"))
    middle = slice(200, -200)
    for i in range(2):
        miss = motion.q[middle, i] - q[middle, i]
        assert np.std(miss) < 0.08 * np.std(q[:, i])


@pytest.mark.parametrize("samples", [4, 7, 21])
def test_a_recording_that_is_too_short_for_its_noise_is_refused(samples: int) -> None:
    t = EVEN[:samples]
    with pytest.raises(InputError, match=f"{samples} samples are too few"):
        motion_of(recording(t, p=sines(t)[0]), machine(p=PLACE))


@pytest.mark.parametrize("seed", [1, 5, 10, 11])
def test_few_samples_of_a_fall_do_not_swing_between_them(seed: int) -> None:
    """56 samples at 15 Hz: as many knots as samples would explain the noise, and give the first or
    the last sample a speed of hundreds of m/s."""
    t = np.arange(56) / 15
    motion = motion_of(recording(t, p=noisy(45 - 3.43 * t**2, 0.04, seed)), machine(p=PLACE))
    assert np.abs(motion.v[:, 0] + 6.86 * t).max() < 3


# --- noise ---------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("smooth", [0.0, 1.0])
def test_the_noise_level_of_white_noise(seed: int, smooth: float) -> None:
    """Within 10 %, alone and on top of a smooth signal 300 times as large."""
    values = smooth * 100 * sines(EVEN)[0] + 0.01 * np.random.default_rng(seed).normal(size=1500)
    assert noise_level(values) == pytest.approx(0.01, rel=0.1)


def test_the_noise_level_with_missing_samples() -> None:
    assert noise_level(with_holes(noisy(sines(EVEN)[0], 3e-4, 3))) == pytest.approx(3e-4, rel=0.15)


def test_the_noise_level_of_too_few_samples_is_not_a_number() -> None:
    assert np.isnan(noise_level(np.arange(20.0)))
    assert np.isnan(noise_level(np.full(200, np.nan)))


# --- columns -------------------------------------------------------------------------------


def test_measurements_stand_in_the_order_of_the_sensors() -> None:
    rig = machine(v=SPEED, p=PLACE)
    columns = measured(recording(EVEN, p=1 + EVEN), rig)
    assert columns[:, 1] == pytest.approx(1 + EVEN)
    assert np.isnan(columns[:, 0]).all()


def test_a_delay_of_an_input_shifts_what_acts() -> None:
    """acting(t) = recorded(t − delay); before the recording its first value is held."""
    inputs = {"f": {"unit": "N", "delay": {"value": 200, "unit": "ms"}}, "g": {"unit": "N"}}
    rig = build(oscillator({"one": push("f"), "two": push("g")}, inputs=inputs))
    u = acting(recording(EVEN, {"g": np.cos(EVEN), "f": EVEN**2}), rig)
    assert u[:, 1] == pytest.approx(np.cos(EVEN))
    assert u[:, 0] == pytest.approx(np.maximum(EVEN - 0.2, 0) ** 2, abs=1e-4)
    assert acting(recording(EVEN), machine(p=PLACE)).shape == (1500, 0)


# --- splines -------------------------------------------------------------------------------


def test_the_spline_basis_and_its_derivatives_are_exact_on_a_quintic() -> None:
    value, first, second = (matrix.toarray() for matrix in spline_basis(UNEVEN, 0.7))
    quintic = np.polynomial.Polynomial([0.3, -1, 0.5, 0.2, -0.05, 0.004])
    coefficients, *_ = np.linalg.lstsq(value, quintic(UNEVEN), rcond=None)
    assert value @ coefficients == pytest.approx(quintic(UNEVEN), abs=1e-9)
    assert first @ coefficients == pytest.approx(quintic.deriv(1)(UNEVEN), abs=1e-8)
    assert second @ coefficients == pytest.approx(quintic.deriv(2)(UNEVEN), abs=1e-6)
    assert value.sum(axis=1) == pytest.approx(np.ones(1500))


@pytest.mark.parametrize(("fault", "at_most"), [("offset", 2.0), ("gain", 3.0)])
def test_what_a_second_sensor_gets_wrong_is_no_noise(fault: str, at_most: float) -> None:
    """A fault of ten times the noise in a rate beside a good place counted as noise of ten and
    seven times its size; a part is left, for the splines give way to both sensors."""
    x, v, _ = sines(EVEN)
    rate = 3e-3
    faulty = {"offset": v + 10 * rate, "gain": v * (1 + 10 * rate / v.std())}[fault]
    sensors = {"p": noisy(x, 3e-4, 1), "v": noisy(faulty, rate, 2)}
    reported = motion_of(recording(EVEN, **sensors), machine(p=PLACE, v=SPEED)).sd
    size = reported / [3e-4, rate]
    assert np.all(size > 0.85)
    assert np.all(size < at_most)


def test_a_part_without_mass_that_no_sensor_shows_is_estimated_by_the_model() -> None:
    """At its start nothing acts on the twisted shaft of a car, whose rate alone has a force."""
    model = read_model(MODELS / "car.toml")
    t = 0.01 * np.arange(200)
    run = simulate(model, end=float(t[-1]), step=0.01, inputs={"torque": lambda now: 80.0})
    sensors = {one.name: run.y[:, j].copy() for j, one in enumerate(model.sensors)}
    made = Recording("car", run.t, {"torque": np.full(run.t.size, 80.0)}, sensors)
    motion = motion_of(made, build(model))
    assert "twist" in motion.blind
    assert np.isfinite(motion.q).all()
