"""The same machine and recording, told in another way, get the same diagnosis.

Units, the origin of time, names, the order of what is listed, the sense in which a coordinate
counts, fewer samples a second, and channels that say nothing change neither what is found nor its
values by more than their deviation. Once for one coordinate and once for two in one mechanism.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import symhyb as sh
from symhyb.discrepancy.results import Diagnosis
from symhyb.model.read import parse_model

pytestmark = pytest.mark.thorough

ROOT = Path(__file__).parents[2]
Texts = Mapping[str, str]
"""What stands in a model file, and what in its place."""


@dataclass(frozen=True)
class Told:
    """A model file with the columns of a recording, and what tells them in another way."""

    model: str
    columns: dict[str, np.ndarray]
    units: Texts
    """Sensors in the model file, in other units."""
    scaled: Mapping[str, tuple[str, float]]
    """The header of a column for these units, and by how much its numbers are larger."""
    names: Texts
    headers: Texts
    mirror: Texts
    still: str
    """A sensor's sum of zero."""


def oscillator() -> Told:
    """A mass on a hard spring that lacks its friction: the recording of the demonstration."""
    file = ROOT / "studies" / "oscillator" / "train.csv"
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    return Told(
        (ROOT / "models" / "oscillator.toml").read_text(encoding="utf-8"),
        dict(zip(("t", "f", "position", "speed"), table.T, strict=True)),
        units={
            '"q",  unit = "m",   sd = 0.0085': '"q",  unit = "mm", sd = 8.5',
            '"q\'", unit = "m/s", sd = 0.026': '"q\'", unit = "mm/s", sd = 26',
        },
        scaled={"f": ("f [kN]", 1e-3), "position": ("position", 1e3), "speed": ("speed", 1e3)},
        names={
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
        },
        headers={"f": "push", "position": "laser"},
        mirror={},  # the spring is odd
        still="0*q",
    )


RAIL = """
[elements.rail]
kind    = "friction"
on      = "x"
coulomb = "F_c"

[sensors]"""


def cart() -> Told:
    """A cart with a pole on a rubber band that lacks the friction of its rail."""
    text = (ROOT / "models" / "cartpole.toml").read_text(encoding="utf-8")
    friction = {"[inputs]": 'F_c = { value = 0.5, unit = "N" }\n\n[inputs]', "\n[sensors]": RAIL}
    machine = sh.build(parse_model(replaced(text, friction)))
    t = np.arange(0, 15, 0.01)
    push = 1.5 * np.sin(2.1 * t) + 1.2 * np.sin(5.3 * t) + 0.8 * np.sin(9.7 * t)
    start = np.array([0.0, 0.2]), np.zeros(2)
    run = sh.simulate(machine, sh.Scenario(t, *start, t, push[:, None]))
    noise = np.random.default_rng(1).standard_normal(run.q.shape) * [1e-4, 1e-3]
    x, phi = (run.q + noise).T
    return Told(
        text,
        {"t": t, "push": push, "cart": x, "pole": phi},
        units={
            '"x",   unit = "m",   sd = 1e-4': '"x",   unit = "mm",   sd = 0.1',
            '"phi", unit = "rad", sd = 1e-3': '"phi", unit = "deg", sd = 0.0572958',
        },
        scaled={
            "push": ("push [kN]", 1e-3),
            "cart": ("cart", 1e3),
            "pole": ("pole", np.degrees(1)),
        },
        names={
            "phi": "swing",
            "m_p": "bob",
            "pivot": "pin",
            "bodies.cart": "bodies.sled",
            "cart = {": "sledge = {",
        },
        headers={"cart": "sledge"},
        mirror={'["1.5*a"': '["-1.5*a"', "start = 0.2": "start = -0.2"},
        still="0*x",
    )


def replaced(text: str, texts: Texts) -> str:
    for old, new in texts.items():
        assert old in text, old
        text = text.replace(old, new)
    return text


def as_it_is(told: Told) -> Told:
    return told


def in_other_units(told: Told) -> Told:
    """Of length and angle in the model file, of force in the header."""
    units = {name: told.scaled.get(name, (name, 1.0)) for name in told.columns}
    columns = {new: told.columns[old] * factor for old, (new, factor) in units.items()}
    return replace(told, model=replaced(told.model, told.units), columns=columns)


def later(told: Told) -> Told:
    return replace(told, columns=told.columns | {"t": told.columns["t"] + 1234.0})


def renamed(told: Told) -> Told:
    """Other names for a coordinate, a parameter, an element, and channels."""
    columns = {told.headers.get(name, name): values for name, values in told.columns.items()}
    return replace(told, model=replaced(told.model, told.names), columns=columns)


def in_another_order(told: Told) -> Told:
    """Tables, coordinates, sensors and columns from the last to the first."""
    head, *tables = re.split(r"(?m)^(?=\[)", told.model)
    listed = ("[coordinates]", "[parameters]", "[sensors]")
    tables = [_turned(one) if one.startswith(listed) else one for one in tables]
    model = "\n".join([head, *reversed(tables)])
    return replace(told, model=model, columns=dict(reversed(told.columns.items())))


def _turned(table: str) -> str:
    head, *lines = table.splitlines()
    return "\n".join([head, *reversed(lines)]) + "\n"


def mirrored(told: Told) -> Told:
    """What was forward is backward."""
    columns = {name: v if name == "t" else -v for name, v in told.columns.items()}
    return replace(told, model=replaced(told.model, told.mirror), columns=columns)


def every_second_sample(told: Told) -> Told:
    return replace(told, columns={name: v[::2] for name, v in told.columns.items()})


def with_channels_that_say_nothing(told: Told) -> Told:
    """A column that no one asked for, and a sensor that stands still."""
    text = told.model
    text += f'\nstill = {{ measures = "{told.still}", unit = "m", sd = 0.001 }}\n'
    noise = 0.001 * np.random.default_rng(1).standard_normal(told.columns["t"].size)
    more = {"still": noise, "room temperature": 20 + noise}
    return replace(told, model=text, columns=told.columns | more)


def diagnosed(folder: Path, told: Told) -> Diagnosis:
    (folder / "model.toml").write_text(told.model, encoding="utf-8")
    table = np.column_stack(list(told.columns.values()))
    header = ",".join(told.columns)
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


Reference = tuple[Told, Diagnosis]


@pytest.fixture(scope="module", params=[oscillator, cart], ids=lambda told: told.__name__)
def reference(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Reference:
    told = request.param()
    return told, diagnosed(tmp_path_factory.mktemp("reference"), told)


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
    reference: Reference, tmp_path: Path, tell: Callable[[Told], Told]
) -> None:
    told, plain = reference
    found = diagnosed(tmp_path, tell(told))
    assert plain.verdict == found.verdict == "missing physics"
    expected, values = numbers(plain), numbers(found)
    assert "friction.coulomb" in expected
    assert values.keys() == expected.keys()
    # the accuracy of the numerics is a part of a deviation, and no smaller with more samples
    fewer = np.sqrt(2) if tell is every_second_sample else 1.0
    for name, (value, sd) in expected.items():
        assert abs(values[name][0] - value) <= sd * fewer, name
        assert 0.7 * sd <= values[name][1] <= 1.3 * sd * fewer, name
