"""The same machine and recording, told in another way, get the same diagnosis.

Units, the origin of time, names, the order of what is listed, the sense in which a coordinate
counts, fewer samples a second, and channels that say nothing change neither what is found nor its
values by more than their deviation.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import symhyb as sh
from symhyb.discrepancy.results import Diagnosis

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent
MODEL = (ROOT / "models" / "oscillator.toml").read_text(encoding="utf-8")
TRAIN = np.loadtxt(ROOT / "studies" / "oscillator" / "train.csv", delimiter=",", skiprows=1)
NAMES = ("t", "f", "position", "speed")
Told = tuple[str, dict[str, np.ndarray]]
"""A model file and the columns of a recording."""


def as_it_is() -> Told:
    return MODEL, dict(zip(NAMES, TRAIN.T, strict=True))


def in_other_units() -> Told:
    """Millimetres and millimetres a second; the force in kilonewtons, as the header says."""
    text, columns = as_it_is()
    text = text.replace('"q",  unit = "m",   sd = 0.0085', '"q",  unit = "mm", sd = 8.5')
    text = text.replace('"q\'", unit = "m/s", sd = 0.026', '"q\'", unit = "mm/s", sd = 26')
    columns = {name: 1e3 * values for name, values in columns.items()}
    return text, {
        "t": columns["t"] / 1e3,
        "f [kN]": columns["f"] / 1e6,
        "position": columns["position"],
        "speed": columns["speed"],
    }


def later() -> Told:
    text, columns = as_it_is()
    return text, columns | {"t": columns["t"] + 1234.0}


RENAMED = {
    "q = {": "w = {",
    "m = {": "load = {",
    "c = {": "k3 = {",
    "f = {": "push = {",
    'mass = "m"': 'mass = "load"',
    'at   = ["q"': 'at   = ["w"',
    "[elements.spring]": "[elements.rod]",
    'on    = "q"': 'on    = "w"',
    'cubic = "c"': 'cubic = "k3"',
    'force = "f"': 'force = "push"',
    "position = {": "laser = {",
    'measures = "q': 'measures = "w',
}


def renamed() -> Told:
    """Other names for the coordinate, mass, spring and channels."""
    text, columns = as_it_is()
    for old, new in RENAMED.items():
        text = text.replace(old, new)
    names = {"f": "push", "position": "laser"}
    return text, {names.get(name, name): values for name, values in columns.items()}


def in_another_order() -> Told:
    """Tables of elements and sensors, and columns, from the last to the first."""
    text, columns = as_it_is()
    head, spring, rest = text.partition("[elements.spring]")
    spring_body, drive, rest = rest.partition("[elements.drive]")
    drive_body, sensors, sensors_body = rest.partition("[sensors]")
    text = head + sensors + sensors_body + "\n" + drive + drive_body + spring + spring_body
    return text, dict(reversed(columns.items()))


def mirrored() -> Told:
    """What was forward is backward; the spring is odd, so the model stays as it is."""
    text, columns = as_it_is()
    return text, {name: values if name == "t" else -values for name, values in columns.items()}


def every_second_sample() -> Told:
    text, columns = as_it_is()
    return text, {name: values[::2] for name, values in columns.items()}


def with_channels_that_say_nothing() -> Told:
    """A column that no one asked for, and a sensor that stands still."""
    text, columns = as_it_is()
    text += '\nstill = { measures = "0*q", unit = "m", sd = 0.001 }\n'
    noise = 0.001 * np.random.default_rng(1).standard_normal(TRAIN.shape[0])
    return text, columns | {"still": noise, "room temperature": 20 + noise}


def diagnosed(folder: Path, told: Told) -> Diagnosis:
    text, columns = told
    (folder / "model.toml").write_text(text, encoding="utf-8")
    table = np.column_stack(list(columns.values()))
    header = ",".join(columns)
    np.savetxt(folder / "train.csv", table, delimiter=",", header=header, comments="", fmt="%.12g")
    model = sh.read_model(folder / "model.toml")
    return sh.diagnose(model, sh.read_recording(folder / "train.csv", model))


def numbers(diagnosis: Diagnosis) -> dict[str, tuple[float, float]]:
    """Every value with its deviation by kind and term."""
    return {
        f"{found.element.kind}.{one.term}": (one.value, one.sd)
        for found in diagnosis.found
        for one in found.estimates
    }


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    return diagnosed(tmp_path_factory.mktemp("reference"), as_it_is())


@pytest.mark.parametrize(
    "tell",
    [
        in_other_units,
        later,
        renamed,
        in_another_order,
        mirrored,
        every_second_sample,
        with_channels_that_say_nothing,
    ],
    ids=lambda tell: tell.__name__,
)
def test_the_same_thing_told_otherwise_is_the_same(
    reference: Diagnosis, tmp_path: Path, tell: Callable[[], Told]
) -> None:
    found = diagnosed(tmp_path, tell())
    assert reference.verdict == found.verdict == "missing physics"
    expected, values = numbers(reference), numbers(found)
    assert values.keys() == expected.keys()
    fewer = np.sqrt(2) if tell is every_second_sample else 1.0
    for name, (value, sd) in expected.items():
        assert abs(values[name][0] - value) <= sd * fewer, name
        assert values[name][1] == pytest.approx(sd * fewer, rel=0.3), name
