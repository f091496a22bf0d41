"""What is exported of a model, and what is refused, in one sentence."""

import hashlib
import json
import math
from pathlib import Path

import numpy as np
import pytest
from builders import model_of, oscillator, push
from fmus import FOUND, element, machine, whole

from symhyb.errors import InputError
from symhyb.export.functions.modes import SMOOTHING
from symhyb.export.spec import si_unit, spec_of
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.network import FADE
from symhyb.units import parse_unit


def reported(spec, x=(), u=(), t=0.0, **parameters: float) -> dict[str, float]:
    """Outputs by name."""
    e = spec.exported
    names = [name for _, name in e.parameters]
    p = e.p.copy()
    for name, value in parameters.items():
        p[names.index(name)] = value
    y = e.evaluate(t, np.array(x, float), np.array(u, float), p)[1]
    return dict(zip([f"{kind}.{name}" for kind, name in e.outputs], y, strict=True))


def test_the_force_is_what_a_host_adds() -> None:
    """At +2 m/s, 0.3 m out, with the Maxwell spring at 0.1 m."""
    force = reported(element(), [0.1], [0.3, 2.0])["dF.x"]
    assert force == pytest.approx(-0.5 - 0.4 * 4 - 20 * 0.2, rel=1e-13)


def test_only_what_matters_goes_in() -> None:
    drag = spec_of(machine(), "drag", ("drag",))
    assert drag.exported.inputs == (("v", "x"),)
    assert drag.exported.parameters == (("p", "b"),)
    assert drag.exported.states == ()
    assert whole().exported.inputs == (("u", "f"),)
    assert [v.name for v in whole().of_role("state")] == ["q.x", "v.x", "z.relax"]


def test_everything_is_in_si_with_its_unit() -> None:
    by_name = {v.name: v for v in element().variables}
    assert by_name["p.vt"].start == 1e-3
    units = {name: by_name[name].unit.text for name in ("p.vt", "z.relax", "der(z.relax)", "dF.x")}
    assert units == {"p.vt": "m/s", "z.relax": "m", "der(z.relax)": "m/s", "dF.x": "N"}


@pytest.mark.parametrize(
    ("text", "si"),
    [
        ("mm", "m"),
        ("deg", "rad"),
        ("rpm", "1/s"),
        ("kN/mm", "kg/s^2"),
        ("N*m", "N*m"),
        ("mm/m", "1"),
    ],
)
def test_units_are_said_shortly(text: str, si: str) -> None:
    unit = si_unit(parse_unit(text))
    assert unit.text == si
    assert unit.factor == 1.0
    assert unit.same_dimension(parse_unit(text))


def test_an_imposed_motion_goes_in() -> None:
    model = model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m", "imposed": True}},
        parameters={"m": (1.0, "kg"), "k": (9.0, "N/m"), "l": (1.0, "m")},
        points={"a": ["x", "0"], "b": ["l + y", "0"]},
        bodies={"mass": {"mass": "m", "at": "a"}},
        elements={"s": {"kind": "spring", "between": ["a", "b"], "stiffness": "k", "length": "l"}},
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
    e = spec_of(model, "driven", whole=True).exported
    assert e.inputs == (("q", "y"), ("v", "y"), ("a", "y"))
    rates, _ = e.evaluate(0.0, np.array([0.0, 0.0]), np.array([0.5, 0.0, 0.0]), e.p)
    assert rates == pytest.approx([0.0, 9.0 * 0.5], rel=1e-13)


def test_a_jump_of_sgn_is_smoothed_unless_reported_otherwise() -> None:
    model = oscillator(
        {"dry": {"kind": "law", "on": "x", "force": "-fc*sign(x')"}}, {"fc": (2.0, "N")}
    )
    spec = spec_of(model, "dry", ("dry",))
    assert reported(spec, u=[SMOOTHING])["dF.x"] == pytest.approx(-2 * math.tanh(1), rel=1e-14)
    assert reported(spec, u=[1e-9], smoothing=0.0)["dF.x"] == -2.0
    assert reported(spec, u=[1.0])["dF.x"] == -2.0


def learnt(folder: Path) -> Model:
    """A network of x alone, trained between −1 and 1 m: F = 3 tanh(2 x)."""
    layers = [
        {"weights": [[2.0]], "bias": [0.0], "activation": "tanh"},
        {"weights": [[1.0]], "bias": [0.0], "activation": "identity"},
    ]
    text = json.dumps(
        {
            "symhyb-network": 1,
            "mean": [0.0],
            "scale": [1.0],
            "gain": 3.0,
            "offset": 0.0,
            "layers": layers,
        }
    )
    (folder / "net.json").write_text(text, encoding="utf-8")
    digest = hashlib.sha256(text.encode()).hexdigest()
    source = f"""
symhyb = 1
[coordinates]
x = {{ unit = "m" }}
[parameters]
m = {{ value = 1.0, unit = "kg" }}
[bodies.one]
mass = "m"
at = ["x", "0"]
[elements.rest]
kind = "network"
on = "x"
weights = "net.json"
sha256 = "{digest}"
inputs = ["x"]
trust = [[-1.0, 1.0]]
"""
    return parse_model(source, str(folder / "model.toml"))


def test_a_network_says_whether_it_was_trained_there(tmp_path: Path) -> None:
    spec = spec_of(learnt(tmp_path), "net", ("rest",))
    assert spec.exported.outputs == (("dF", "x"), ("trust", "rest"))
    assert reported(spec, u=[0.4]) == {
        "dF.x": pytest.approx(3 * math.tanh(0.8), rel=1e-14),
        "trust.rest": 1.0,
    }
    edge = reported(spec, u=[1 + FADE])  # half of the way out: FADE is a share of a box 2 m wide
    assert edge["trust.rest"] == pytest.approx(0.5, rel=1e-12)
    assert edge["dF.x"] == pytest.approx(1.5 * math.tanh(2 * (1 + FADE)), rel=1e-12)
    assert reported(spec, u=[2.0]) == {"dF.x": 0.0, "trust.rest": 0.0}


def test_a_network_in_the_whole_machine_is_that_of_the_machine(tmp_path: Path) -> None:
    """In matrices here, in scalars there; the forces fade on the way out."""
    model = learnt(tmp_path)
    spec, machine = spec_of(model, "net", whole=True), build(model)
    assert spec.exported.outputs == (("trust", "rest"),)
    for x in (-0.7, 0.3, 1.1, 1.5):
        rates, y = spec.exported.evaluate(0.0, np.array([x, 0.5]), np.zeros(0), spec.exported.p)
        (reported,) = call(
            machine.acceleration, ([x], [0.5], [], [], 0.0, machine.values, [0.0], [])
        )
        assert rates == pytest.approx([0.5, reported.item()], rel=1e-13, abs=1e-13)
        assert y[0] == reported_trust(x)


def reported_trust(x: float) -> float:
    inside = 1 - min(max(abs(x) - 1, 0) / (2 * FADE), 1)
    return pytest.approx(inside**2 * (3 - 2 * inside), abs=1e-12)


def test_weights_that_were_changed_are_not_exported(tmp_path: Path) -> None:
    model = learnt(tmp_path)
    file = tmp_path / "net.json"
    file.write_text(file.read_text().replace("3.0", "3.1"), encoding="utf-8")
    with pytest.raises(InputError, match="it was changed"):
        spec_of(model, "net", ("rest",))


def test_a_mass_cannot_be_a_force_element_but_part_of_the_whole() -> None:
    model = oscillator(
        {"water": {"kind": "added_mass", "on": "x", "mass": "mw"}, "d": push("f")},
        {"mw": (0.3, "kg")},
        inputs={"f": {"unit": "N"}},
    )
    with pytest.raises(InputError, match=r"acceleration.*--whole"):
        spec_of(model, "water", ("water",))
    e = spec_of(model, "all", whole=True).exported
    assert e.evaluate(0.0, np.zeros(2), np.array([3.0]), e.p)[0][1] == pytest.approx(2.0)


def test_a_delay_of_an_input_is_refused() -> None:
    late = {"f": {"unit": "N", "delay": {"value": 0.1, "unit": "s"}}}
    model = oscillator({"d": push("f")}, inputs=late)
    for order in ({"whole": True}, {"elements": ("d",)}):
        with pytest.raises(InputError, match="delay"):
            spec_of(model, "late", **order)


def test_an_actuator_of_an_input_is_refused() -> None:
    slow = {"f": {"unit": "N", "lag": {"value": 0.1, "unit": "s"}, "rate_limit": 3.0}}
    model = oscillator({"d": push("f")}, inputs=slow)
    for order in ({"whole": True}, {"elements": ("d",)}):
        with pytest.raises(InputError, match=r"an actuator \(rate limit, lag\).*let the host give"):
            spec_of(model, "slow", **order)


@pytest.mark.parametrize("name", ["", "2nd", "my-law", "int", "größe", "a b", "x" * 80])
def test_names_that_c_does_not_know_are_refused(name: str) -> None:
    with pytest.raises(InputError, match="--name"):
        spec_of(machine(), name, FOUND)


def test_what_to_export_must_be_said() -> None:
    with pytest.raises(InputError, match="no element of the model was found"):
        spec_of(machine(), "all")
    with pytest.raises(InputError, match=r"no such element; it has: cubic, rub"):
        spec_of(machine(), "one", ("rubb",))
    with pytest.raises(InputError, match="not both"):
        spec_of(machine(), "one", FOUND, whole=True)
