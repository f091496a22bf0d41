"""Found elements of every kind: said, written as a model file, read back and in diagnosis.json."""

import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from importlib import resources
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import sympy as sp

import symhyb as sh
from symhyb.correction.naming.findings import Named, found_of, named, symbol_of
from symhyb.correction.naming.textbook import critical_share
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.results import Alternative, Diagnosis, Found, Verdict
from symhyb.discrepancy.words.wording import verdict_sentence
from symhyb.laws.maths import Motion
from symhyb.mechanics.laws import action_of
from symhyb.model.read import parse_model
from symhyb.model.types import Between, Element, Model, On, Place
from symhyb.model.vocabulary import KINDS
from symhyb.report import to_json

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]
TEXT = """symhyb = 1
title = "Arm and slide"
[coordinates]
x = { unit = "m" }
phi = { unit = "deg" }
[parameters]
m = { value = 1.2, unit = "kg" }
r = { value = 0.4, unit = "m" }
[inputs]
k = { unit = "N" }
[points]
wall = { at = ["-r", "r"] }
hook = { at = ["x", "0"] }
[bodies.slide]
mass = "m"
at = ["x", "0"]
[bodies.arm]
mass = "m"
at = ["r*cos(phi)", "r*sin(phi)"]
[elements.motor]
kind = "force"
on = "x"
force = "k"
[sensors]
laser = { measures = "x", unit = "m" }
"""
PROVENANCE = (("by", "sparse"), ("from", "run.csv"), ("nrmse", (0.2, 0.02)))
SHAPES: dict[str, dict[str, float]] = {
    "spring": {"stiffness": 310.5, "quadratic": -20.0, "cubic": 9000.0},
    "damper": {"damping": 0.7, "asymmetry": 0.14},
    "drag": {"drag": 0.5},
    "friction": {"coulomb": 0.5, "static": 1.3, "stribeck": 0.1, "transition": 1e-4},
    "gap": {"stiffness": 900.0, "clearance": 0.05},
    "hysteresis": {"stiffness": 120.0, "beta": 40.0, "gamma": 20.0, "exponent": 1.5, "play": 1e-3},
    "friction_dynamic": {"coulomb": 1.2, "stiffness": 300.0},
    "relaxation": {"stiffness": 150.0, "damping": 15.0},
    "constant": {"constant": -3.16},
    "harmonic": {"amplitude": 1.2, "frequency": 3.7, "phase": 0.6},
    "ripple": {"amplitude": 1.5, "period": 0.03, "phase": 0.4},
    "added_mass": {"mass": 0.25},
}
HELD = {"transition", "exponent"}  # set, not fitted


def item_of(kind: str, place: Place, side: str = "upper") -> Named:
    values = {
        key: (value, float("nan") if key in HELD else 0.01 * abs(value))
        for key, value in SHAPES[kind].items()
    }
    return Named(kind, place, (0,), values, (("side", side),) if kind == "gap" else ())


def found_at(kind: str, place: Place) -> Found:
    return found_of(parse_model(TEXT), item_of(kind, place), f"found_{kind}", PROVENANCE, 0.8, None)


def numbers(element: Element) -> dict[str, tuple[float, float | None, str]]:
    own = {item.name: item for item in element.parameters}
    entries = {key: own[str(expression)] for key, expression in element.values}
    return {key: (item.value, item.sd, item.unit.text) for key, item in entries.items()}


@pytest.mark.parametrize("place", [On("x"), On("phi"), Between("wall", "hook")])
@pytest.mark.parametrize("kind", SHAPES)
def test_what_was_found_is_read_back_with_equal_numbers(
    kind: str, place: Place, tmp_path: Path
) -> None:
    effect = found_at(kind, place)
    corrected = sh.apply(parse_model(TEXT), [effect])
    assert corrected.text.startswith(TEXT)
    sh.write_model(corrected, tmp_path / "corrected.toml")
    for model in (corrected, sh.read_model(tmp_path / "corrected.toml")):
        read = model.elements[-1]
        assert (read.kind, read.place, read.options) == (kind, place, effect.element.options)
        made, back = numbers(effect.element), numbers(read)
        assert back.keys() == made.keys() == SHAPES[kind].keys()
        for key, (value, sd, unit) in made.items():
            assert back[key][0] == pytest.approx(value, rel=1e-14)
            assert back[key][1] == (None if sd is None else pytest.approx(sd, rel=1e-5))
            assert back[key][2] == unit
            own = next(p for p in read.parameters if str(read.value(key)) == p.name)
            assert own.si == pytest.approx(SHAPES[kind][key], rel=1e-9)


def test_every_kind_is_valid_in_the_contract(cases: Cases) -> None:
    _, verdict = cases["missing"]()
    effects = tuple(found_at(kind, On("phi")) for kind in SHAPES)
    rivals = tuple(
        Alternative(None, e.element.kind, e.estimates, 1.0, On("x"), options=e.element.options)
        for e in effects
    )
    said = verdict_sentence("missing physics", effects)
    content = contract_of(Diagnosis("missing physics", said, effects, (), (), rivals), verdict)
    gap = next(one for one in content["found"] if one["kind"] == "gap")
    assert gap["options"] == {"side": "upper"}
    assert "options" not in content["found"][0]
    assert {one["term"] for one in gap["parameters"].values()} == {"stiffness", "clearance"}
    for one in content["found"]:
        assert {p["term"] for p in one["parameters"].values()} == set(SHAPES[one["kind"]]) - HELD
    assert [r.get("options") for r in content["alternatives"] if r["kind"] == "gap"] == [
        {"side": "upper"}
    ]


def contract_of(diagnosis: Diagnosis, verdict: Verdict) -> dict[str, list[dict[str, object]]]:
    schema = resources.files("symhyb.report").joinpath("diagnosis.schema.json").read_text("utf-8")
    content = to_json(diagnosis, verdict)
    jsonschema.validate(content, json.loads(schema), jsonschema.Draft202012Validator)
    return content


def test_letters_of_coordinates_and_inputs_are_left_to_them() -> None:
    model = parse_model(TEXT)
    assert symbol_of(model, "damper", "damping") == "d"
    assert symbol_of(model, "spring", "stiffness") == "stiffness"  # k is the motor
    both = replace(model, inputs=(*model.inputs, replace(model.inputs[0], name="stiffness")))
    assert symbol_of(both, "spring", "stiffness") == "k_"


def test_springs_join_and_stops_stay_apart() -> None:
    x, model = On("x"), parse_model(TEXT)
    springs = [Hypothesis("spring", x, (key,), (False,)) for key in ("stiffness", "cubic")]
    stops = [
        Hypothesis(
            "gap",
            x,
            ("stiffness",),
            (True,),
            (("clearance", 0.05),),
            ("clearance",),
            options=(("side", side),),
        )
        for side in ("upper", "lower")
    ]
    items = named(settled(model, (springs[0], stops[0], springs[1], stops[1])))
    assert items[0].values == {"stiffness": (1.0, 0.1), "cubic": (4.0, 0.1)}
    assert [(item.kind, item.causes) for item in items] == [
        ("spring", (0, 2)),
        ("gap", (1,)),
        ("gap", (3,)),
    ]
    assert [item.options for item in items[1:]] == [(("side", "upper"),), (("side", "lower"),)]
    reported = [
        found_of(model, item, f"found_{i}", PROVENANCE, None, None) for i, item in enumerate(items)
    ]
    assert [one.law for one in reported] == [
        "stiffness*s + cubic*s^3",
        "stiffness*max(s - clearance, 0)",
        "stiffness*min(s + clearance, 0)",
    ]
    assert "on the lower side" in reported[2].sentence


def settled(model: Model, causes: tuple[Hypothesis, ...]) -> Refined:
    """A fitted structure whose numbers are 1, 2, 3 … with a standard deviation of 0.1."""
    paths = tuple(f"cause{i}.{key}" for i, cause in enumerate(causes) for key in cause.keys)
    values, none = np.arange(1.0, len(paths) + 1.0), np.zeros(0)
    fit = Fit(values, 0.01 * np.eye(len(paths)), none, none.astype(int), none.astype(bool), 1.0, ())
    return Refined(causes, sh.build(model), paths, values, fit)


OSCILLATOR = """symhyb = 1
title = "Oscillator"
[coordinates]
x = { unit = "mm", start = 20.0 }
[parameters]
m = { value = 1.2, unit = "kg" }
k = { value = 300.0, unit = "N/m" }
d = { value = 0.6, unit = "N*s/m" }
[bodies.slide]
mass = "m"
at = ["x", "0"]
[elements.rest]
kind = "spring"
on = "x"
stiffness = "k"
[elements.loss]
kind = "damper"
on = "x"
damping = "d"
"""


def test_damping_is_compared_with_critical_damping_of_a_linear_model() -> None:
    model, x = parse_model(OSCILLATOR), On("x")
    critical = 2.0 * math.sqrt(1.2 * 300.0)
    assert critical_share(model, x, 0.8) == pytest.approx(0.8 / critical, rel=1e-6)
    damping = replace(item_of("damper", x), values={"damping": (0.8, 0.01)})
    reported = found_of(model, damping, "found_damper", PROVENANCE, None, None)
    assert reported.sentence == (
        "On x, viscous damping of 0.800 ± 0.010 N·s/m resists the motion, 2.1 % of the critical "
        "damping of the model."
    )
    sided = found_of(model, item_of("damper", x), "found_damper", PROVENANCE, None, None)
    assert "critical" not in sided.sentence


@pytest.mark.parametrize(
    "more",
    [
        'cubic = "9000*k/x_0**2"',
        'quadratic = "2*k/x_0"',
    ],
)
def test_a_model_that_is_not_linear_has_no_critical_damping(more: str) -> None:
    text = OSCILLATOR.replace('stiffness = "k"', f'stiffness = "k"\n{more}')
    text = text.replace("[bodies", 'x_0 = { value = 1.0, unit = "m" }\n[bodies')
    assert critical_share(parse_model(text), On("x"), 0.8) is None


def test_critical_damping_needs_one_coordinate_and_a_spring() -> None:
    assert critical_share(parse_model(TEXT), On("x"), 0.8) is None
    free = OSCILLATOR.replace('stiffness = "k"', 'stiffness = "0*k"')
    assert critical_share(parse_model(free), On("x"), 0.8) is None
    rubbing = OSCILLATOR.replace('kind = "damper"', 'kind = "friction"')
    rubbing = rubbing.replace('damping = "d"', 'coulomb = "d*v_0"')
    rubbing = rubbing.replace("[bodies", 'v_0 = { value = 1.0, unit = "m/s" }\n[bodies')
    assert critical_share(parse_model(rubbing), On("x"), 0.8) is None
    short = 'symhyb = 1\n[mujoco]\nfile = "a.xml"\n[coordinates]\nx = { unit = "m" }\n'
    short += '[sensors]\ny = { measures = "x", unit = "m" }\n'
    assert critical_share(parse_model(short), On("x"), 0.8) is None  # another program has the rest


LAWS = [
    *((kind, tuple(keys), "upper") for kind, keys in SHAPES.items() if kind != "added_mass"),
    ("spring", ("cubic",), ""),
    ("damper", ("damping",), ""),
    ("friction", ("coulomb", "transition"), ""),
    ("friction", ("coulomb", "transition", "asymmetry"), ""),
    ("friction", ("coulomb", "transition", "slope"), ""),
    ("friction", ("coulomb", "static", "stribeck", "transition", "slope", "around"), ""),
    ("gap", ("stiffness", "clearance"), "lower"),
    ("gap", ("stiffness", "clearance", "damping"), "both"),
    ("gap", ("stiffness",), "both"),
    ("hysteresis", ("stiffness", "beta", "gamma"), ""),
    ("hysteresis", ("stiffness", "gamma"), ""),
    ("friction_dynamic", ("coulomb", "static", "stribeck", "stiffness", "micro_damping"), ""),
]


@pytest.mark.parametrize(("kind", "keys", "side"), LAWS)
def test_the_law_as_text_is_the_law_that_acts(kind: str, keys: tuple[str, ...], side: str) -> None:
    s, r, z, t = sp.symbols("s r z t", real=True)
    numbers_of = {**{"asymmetry": 0.2, "damping": 3.0, "micro_damping": 2.0}, **SHAPES[kind]}
    numbers_of |= {"static": 1.3, "stribeck": 0.1, "transition": 1e-2, "exponent": 1.5}
    numbers_of |= {"slope": 6.0, "around": 0.05}
    options = (("side", side),) if kind == "gap" else ()
    values = {key: sp.Float(numbers_of[key]) for key in keys}
    law = action_of(Element("e", kind, On("x"), (), options=options), Motion(s, r, (z,), t), values)
    force, rate = read_law(KINDS[kind].text(keys, dict(options)), values, (s, r, z, t))
    grid = np.random.default_rng(0).uniform(-0.2, 0.2, (4, 60))
    expected = sp.lambdify((s, r, z, t), law.force, "numpy")(*grid)
    np.testing.assert_allclose(
        sp.lambdify((s, r, z, t), force, "numpy")(*grid), expected, rtol=1e-9, atol=1e-12
    )
    assert (rate is None) == (not law.inner)
    if rate is not None:
        inner = sp.lambdify((s, r, z, t), law.inner[0], "numpy")(*grid)
        np.testing.assert_allclose(sp.lambdify((s, r, z, t), rate, "numpy")(*grid), inner, 1e-9)


def read_law(
    text: str, values: dict[str, sp.Expr], motion: tuple[sp.Symbol, ...]
) -> tuple[sp.Expr, sp.Expr | None]:
    """The force and the rate of z that a law states as text: ``force, z' = …, g = …``."""
    names = dict(zip(("s", "r", "z", "t"), motion, strict=True)) | values
    names |= {"dead": dead, "sgn": sp.sign, "max": sp.Max, "min": sp.Min, "abs": sp.Abs}
    force, *rest = re.split(r", (?=(?:z'|g|n) = )", text)
    for part in reversed(rest):
        name, _, right = part.partition(" = ")
        names[name.replace("z'", "z_rate")] = expression(right, names)
    return expression(force, names), names.get("z_rate")


def expression(text: str, names: dict[str, sp.Expr]) -> sp.Expr:
    contact = re.sub(r"\(([^()]*) > 0\)", r"Heaviside(\1, 0)", text)
    contact = re.sub(r"\(([^()]*) < 0\)", r"Heaviside(-(\1), 0)", contact)
    plain = contact.replace("s'", "r").replace("z'", "z_rate").replace("^", "**")
    return sp.parse_expr(plain, local_dict=names)


def dead(value: sp.Expr, play: sp.Expr) -> sp.Expr:
    return sp.Max(value - play, 0) + sp.Min(value + play, 0)
