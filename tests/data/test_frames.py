"""Recordings from frames and datasets and back: values, units, time, what is refused."""

import builtins
from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from symhyb.data.recording import Recording, read_recording
from symhyb.errors import InputError
from symhyb.model.read import parse_model

MODEL = parse_model("""symhyb = 1
[coordinates]
x = { unit = "mm" }
phi = { unit = "deg" }
[parameters]
m = { value = 1.0, unit = "kg" }
J = { value = 1.0, unit = "kg*m^2" }
[inputs]
f = { unit = "kN" }
[bodies.block]
mass = "m"
at = ["x", "0"]
[bodies.wheel]
mass = "m"
at = ["0", "0"]
inertia = "J"
angle = "phi"
[elements.push]
kind = "force"
on = "x"
force = "f"
[sensors]
laser = { measures = "x", unit = "mm" }
enc = { measures = "phi", unit = "deg" }
""")
T = np.arange(40) / 100
FORCE, LASER, ENC = 0.2 * np.sin(T), 3.0 + np.cos(5 * T), 90 * np.sin(3 * T) + 0.1


def frame(**more: object) -> pd.DataFrame:
    return pd.DataFrame({"t": T, "f": FORCE, "laser": LASER, "enc": ENC, **more})


def test_a_frame_is_read_in_the_units_of_the_model() -> None:
    run = Recording.from_frame(frame(), MODEL, name="bench")
    assert run.name == "bench"
    np.testing.assert_array_equal(run.t, T)
    np.testing.assert_allclose(run["f"], FORCE * 1e3, rtol=1e-15)
    np.testing.assert_allclose(run["laser"], LASER * 1e-3, rtol=1e-15)
    np.testing.assert_allclose(run["enc"], np.deg2rad(ENC), rtol=1e-15)
    assert run.notes == ()
    assert not run["laser"].flags.writeable


@pytest.mark.parametrize(
    ("columns", "units"),
    [
        ({"laser": LASER / 1000}, {"laser": "m"}),
        ({"laser": LASER / 10}, {"laser": "cm"}),
        ({"laser [m]": LASER / 1000}, None),
        ({"laser [cm]": LASER / 1000}, {"laser": "m"}),  # what is asked for goes first
        ({"laser [cm]": LASER / 1000}, {"laser [cm]": "m"}),
    ],
)
def test_units_come_from_the_argument_or_the_name(columns: dict, units: dict | None) -> None:
    given = frame().drop(columns="laser").assign(**columns)
    run = Recording.from_frame(given, MODEL, units=units)
    np.testing.assert_allclose(run["laser"], LASER * 1e-3, rtol=1e-14)


def test_units_come_from_attrs_where_nothing_else_says() -> None:
    given = frame(laser=LASER / 1000)
    given.attrs["units"] = {"laser": "m"}
    np.testing.assert_allclose(Recording.from_frame(given, MODEL)["laser"], LASER * 1e-3)
    asked = Recording.from_frame(given, MODEL, units={"laser": "cm"})
    np.testing.assert_allclose(asked["laser"], LASER * 1e-5)


@pytest.mark.parametrize(
    "index",
    [
        pd.Index(T),
        pd.Index(T, name="t"),
        pd.Index(T * 1000, name="time [ms]"),
        pd.Index(T * 1000, name="t_ms"),
        pd.to_timedelta(T, unit="s"),
        pd.Timestamp("2026-11-26 12:00") + pd.to_timedelta(T, unit="s"),
    ],
)
def test_the_index_is_the_time(index: pd.Index) -> None:
    given = frame().drop(columns="t").set_index(index)
    columns = {"t": "t_ms [ms]"} if index.name == "t_ms" else None
    run = Recording.from_frame(given, MODEL, columns)
    np.testing.assert_allclose(run.t, T, atol=1e-9)
    np.testing.assert_allclose(run["enc"], np.deg2rad(ENC))


def test_a_column_of_time_goes_before_an_index() -> None:
    run = Recording.from_frame(frame().set_index(pd.Index(7 * T, name="t")), MODEL)
    np.testing.assert_array_equal(run.t, T)


def test_rows_that_only_count_are_no_time() -> None:
    with pytest.raises(InputError, match=r"time t: has no column.*index/1000"):
        Recording.from_frame(frame().drop(columns="t"), MODEL)
    counted = Recording.from_frame(frame().drop(columns="t"), MODEL, {"t": "index/100"})
    np.testing.assert_allclose(counted.t, T)


def test_a_mapping_of_columns_will_do() -> None:
    run = Recording.from_frame({"t": T, "f": FORCE, "y": LASER}, MODEL, {"laser": "y"})
    np.testing.assert_allclose(run["laser"], LASER * 1e-3)
    assert list(run) == ["f", "laser"]


def test_a_frame_is_cleaned_as_a_file_is(tmp_path) -> None:
    """The same columns as a frame and as a file give the same recording."""
    rough = frame()
    rough.loc[5, "laser"] = np.nan
    rough.loc[7, "f"] = np.nan
    rough = pd.concat([rough, rough.tail(1)])
    file = tmp_path / "run.csv"
    rough.to_csv(file, index=False)
    read, made = read_recording(file, MODEL), Recording.from_frame(rough, MODEL)
    assert made.notes == read.notes
    assert any("interpolated" in note for note in made.notes)
    for name in ("t", *read):
        np.testing.assert_allclose(made[name], read[name], rtol=1e-12)  # digits of old readers
    part = Recording.from_frame(rough, MODEL, span=(0.1, None))
    assert part.t[0] == 0.1


def test_there_and_back_is_the_same() -> None:
    run = Recording.from_frame(frame(), MODEL)
    for again in (
        Recording.from_frame(run.to_frame(), MODEL),
        Recording.from_xarray(run.to_xarray(), MODEL),
    ):
        assert list(again) == list(run)
        for name in ("t", *run):
            np.testing.assert_allclose(again[name], run[name], rtol=1e-15)
        assert again.notes == ()


def test_a_frame_has_the_units_of_the_model() -> None:
    shown = Recording.from_frame(frame(), MODEL).to_frame()
    assert list(shown.columns) == ["f", "laser", "enc"]
    assert shown.index.name == "t"
    np.testing.assert_allclose(shown["enc"], ENC, rtol=1e-14)
    np.testing.assert_allclose(shown["laser"], LASER, rtol=1e-14)
    assert shown.attrs["units"] == {"t": "s", "f": "kN", "laser": "mm", "enc": "deg"}


def test_a_recording_made_by_hand_is_shown_in_si_and_read_so() -> None:
    run = Recording("made", T, {"f": FORCE * 1e3}, {"laser": LASER * 1e-3})
    shown = run.to_frame()
    assert shown.attrs["units"] == {"t": "s", "f": "SI", "laser": "SI"}
    np.testing.assert_array_equal(shown["laser"], LASER * 1e-3)
    again = Recording.from_frame(shown, MODEL)
    np.testing.assert_allclose(again["laser"], LASER * 1e-3, rtol=1e-15)
    np.testing.assert_allclose(again["f"], FORCE * 1e3, rtol=1e-15)


def test_a_dataset_is_read_with_its_units() -> None:
    given = xr.Dataset(
        {
            "f": ("time", FORCE),
            "laser": ("time", LASER / 1000, {"units": "m"}),
            "picture": (("time", "pixel"), np.zeros((40, 3))),
        },
        {"time": ("time", T * 1000, {"units": "ms"}), "trial": 3},
    )
    with pytest.raises(InputError, match="must have one dimension, the time; it has"):
        Recording.from_xarray(given, MODEL)
    run = Recording.from_xarray(given.drop_vars("picture"), MODEL)
    np.testing.assert_allclose(run.t, T, rtol=1e-14)
    np.testing.assert_allclose(run["laser"], LASER * 1e-3, rtol=1e-14)
    np.testing.assert_allclose(run["f"], FORCE * 1e3, rtol=1e-14)


def test_a_data_array_is_one_channel() -> None:
    model = parse_model("""symhyb = 1
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 1.0, unit = "kg" }
[bodies.block]
mass = "m"
at = ["x", "0"]
[sensors]
laser = { measures = "x", unit = "mm" }
""")
    array = xr.DataArray(LASER, {"t": T}, ("t",), name="laser")
    np.testing.assert_allclose(Recording.from_xarray(array, model)["laser"], LASER / 1000)


def test_a_dataset_says_its_units() -> None:
    shown = Recording.from_frame(frame(), MODEL, name="bench").to_xarray()
    assert shown["laser"].attrs == {"units": "mm"}
    assert shown["t"].attrs == {"units": "s"}
    assert shown.attrs == {"name": "bench"}
    np.testing.assert_allclose(shown["enc"].values, ENC, rtol=1e-14)


def test_motion_that_is_imposed_and_recorded_is_one_column() -> None:
    model = parse_model("""symhyb = 1
[coordinates]
x = { unit = "mm" }
base = { unit = "mm", imposed = true }
[parameters]
m = { value = 1.0, unit = "kg" }
[bodies.block]
mass = "m"
at = ["x + base", "0"]
[sensors]
x = { measures = "x", unit = "mm" }
base = { measures = "base", unit = "mm" }
""")
    run = Recording.from_frame({"t": T, "x": LASER, "base": ENC}, model)
    shown = run.to_frame()
    assert list(shown.columns) == ["x", "base"]
    np.testing.assert_allclose(shown["base"], ENC, rtol=1e-14)
    moved = Recording("r", run.t, {"base": run["x"]}, run.sensors)
    assert list(moved.to_frame().columns) == ["base (coordinate)", "x", "base"]


WRONG: list[tuple[Callable[[], object], str]] = [
    (lambda: Recording.from_frame([1, 2], MODEL), "must be a frame of pandas or a mapping"),
    (lambda: Recording.from_frame({"t": T, "f": T[:3]}, MODEL), "is no table"),
    (lambda: Recording.from_frame(pd.DataFrame(), MODEL), "has no row or no column"),
    (
        lambda: Recording.from_frame(frame(), MODEL, units={"lasr": "m"}),
        r"units\['lasr'\]: is a unit of no column; did you mean 'laser'",
    ),
    (
        lambda: Recording.from_frame(frame(), MODEL, units={"laser": "furlong"}),
        r"units\['laser'\]: 'furlong' is not a known unit",
    ),
    (
        lambda: Recording.from_frame(frame(), MODEL, units={"laser": "N"}),
        "sensor laser: the column is in N, but the model declares mm",
    ),
    (
        lambda: Recording.from_frame(frame().set_index(["t", "f"]), MODEL),
        "has 2 levels of rows",
    ),
    (
        lambda: Recording.from_frame(pd.concat({"a": frame()}, axis=1), MODEL),
        "has 2 levels of columns",
    ),
    (
        lambda: Recording.from_frame(pd.concat([frame(), frame()[["laser"]]], axis=1), MODEL),
        "column 'laser': stands more than once",
    ),
    (
        lambda: Recording.from_frame(frame(laser=["a"] * 40), MODEL),
        "'a' is not a number, in row 1",
    ),
    (lambda: Recording.from_frame(frame().iloc[::-1], MODEL), "time does not increase"),
    (lambda: Recording.from_frame(frame(t=T + 1j), MODEL), "is complex"),
    (lambda: Recording.from_xarray(frame(), MODEL), "must be a Dataset or a DataArray"),
]


@pytest.mark.parametrize(("call", "said"), WRONG)
def test_what_is_wrong_with_a_frame_is_said(call: Callable[[], object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        call()


def test_a_model_is_needed_to_read_a_frame() -> None:
    with pytest.raises(TypeError, match=r"from_frame: 'model' must be a Model, not str 'm.toml'"):
        Recording.from_frame(frame(), "m.toml")
    with pytest.raises(TypeError, match="from_frame: 'units' must be a mapping by name or None"):
        Recording.from_frame(frame(), MODEL, units="mm")


def test_names_of_columns_are_shown_and_not_obeyed() -> None:
    run = Recording.from_frame(frame(**{"\u001b[31mred": T}), MODEL, name="a\u001b[1mb")
    assert "\u001b" not in "".join((run.name, *run.notes))


def test_without_xarray_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: object) -> object:
        if name == "xarray":
            raise ModuleNotFoundError("No module named 'xarray'", name="xarray")
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(InputError, match=r'pip install "symhyb\[xarray\]"'):
        Recording.from_frame(frame(), MODEL).to_xarray()


def test_channels_are_found_by_name() -> None:
    run = Recording.from_frame(frame(), MODEL)
    assert len(run) == 40
    assert list(run) == ["f", "laser", "enc"]
    assert "laser" in run
    assert "t" in run
    assert "lasr" not in run
    assert run["t"] is run.t
    assert run["laser"] is run.sensors["laser"]
    with pytest.raises(KeyError) as caught:
        run["lasr"]
    assert str(caught.value) == (
        "frame has no channel 'lasr'; did you mean 'laser'?; there are: t, f, laser, enc"
    )
    with pytest.raises(KeyError, match="has no channel 0"):
        run[0]


def test_a_recording_by_hand_needs_no_digest() -> None:
    run = Recording("made", T, {"f": FORCE}, {"laser": LASER})
    same = Recording("other name", T.copy(), {"f": FORCE}, {"laser": LASER})
    other = Recording("made", T, {"f": FORCE}, {"laser": LASER + 1e-9})
    swapped = Recording("made", T, {"laser": LASER}, {"f": FORCE})
    assert len(run.sha256) == 64
    assert run.sha256 == same.sha256
    assert len({run.sha256, other.sha256, swapped.sha256}) == 3
    assert run.shares(same)
    assert not run.shares(other)
    assert run.crop(0.1, 0.35).sha256 == run.sha256
    listed = Recording("made", T.tolist(), {}, {"laser": LASER.tolist()})
    np.testing.assert_array_equal(listed["laser"], LASER)


@pytest.mark.parametrize(
    ("t", "sensors", "said"),
    [
        (T, {"laser": LASER[:-1]}, r"sensors.laser: has shape \(39,\); t has \(40,\)"),
        (T[::-1], {"laser": LASER}, "t: must increase: sample 1 is 0.38 s"),
        (np.where(T[3] == T, np.nan, T), {"laser": LASER}, "t: must increase"),
        (T[:, None], {"laser": LASER}, r"t: must be \(N,\), not \(40, 1\)"),
        (T, {"laser": ["a"] * 40}, "sensors.laser: must be numbers, not list"),
        (T, [LASER], "sensors: must map names to signals, not be list"),
    ],
)
def test_what_is_no_recording_is_refused(t: object, sensors: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        Recording("made", t, {}, sensors)
