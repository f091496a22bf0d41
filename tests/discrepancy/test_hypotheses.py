"""Hypotheses are ordinary elements: their probes add up, act where they say, and read back."""

from dataclasses import replace

import numpy as np
import pytest
from builders import cart_pole, damper, oscillator, push, spring, value

from symhyb.discrepancy.hypotheses import (
    STRIBECK_SHARES,
    TRANSITION_SHARE,
    Hypothesis,
    dull_hypotheses,
    force_hypotheses,
    library,
    natural_length,
    places_of,
    with_channels,
)
from symhyb.model.read import parse_model
from symhyb.model.types import Between, On
from symhyb.model.vocabulary import KINDS
from symhyb.model.write import append_elements, text_of
from symhyb.numeric.machine import build

BAND = Between("post", "tip")


def test_places_are_coordinates_and_the_pairs_that_elements_join() -> None:
    assert places_of(cart_pole()) == (On("x"), On("phi"), BAND)


def test_one_coordinate_is_one_place() -> None:
    """A pair of points that moves with the only coordinate adds nothing but a geometry."""
    bar = {"kind": "spring", "between": ["wall", "block"], "stiffness": "k"}
    assert places_of(oscillator({"bar": bar}, {"k": (5.0, "N/m")})) == (On("x"),)


def test_every_law_of_the_vocabulary_is_tried_at_every_place() -> None:
    tried = force_hypotheses(cart_pole(), {On("x"): 0.5, BAND: 2.0})
    terms = [(h.kind, h.terms) for h in tried if h.place == BAND]
    assert terms == [(h.kind, h.terms) for h in tried if h.place == On("x")]
    assert terms == [
        ("constant", ("constant",)),
        ("spring", ("stiffness",)),
        ("spring", ("quadratic",)),
        ("spring", ("cubic",)),
        ("damper", ("damping",)),
        ("drag", ("drag",)),
        ("friction", ("coulomb",)),
        ("friction", ("coulomb", "static")),
        ("friction", ("coulomb", "static")),
    ]
    for h in tried:
        assert h.positive == (KINDS[h.kind].energy == "dissipative",) * len(h.terms)
        assert h.numbers == len(h.terms) + len(h.refined)


def test_friction_scales_with_the_speed_of_its_place() -> None:
    tried = [h for h in force_hypotheses(cart_pole(), {On("x"): 0.5}) if h.kind == "friction"]
    assert [dict(h.shape)["transition"] for h in tried] == [TRANSITION_SHARE * 0.5] * 3
    assert [dict(h.shape)["stribeck"] for h in tried[1:]] == [0.5 * s for s in STRIBECK_SHARES]
    assert [h.refined for h in tried] == [(), ("stribeck",), ("stribeck",)]
    assert tried[1].family == tried[2].family != tried[0].family


def test_a_place_that_never_moves_loses_no_energy() -> None:
    tried = force_hypotheses(cart_pole(), {On("x"): 0.0})
    assert {h.kind for h in tried} == {"constant", "spring"}


def test_dull_causes_are_parameters_with_sd_and_every_channel() -> None:
    own = {**damper("d"), "parameters": {"d": (3.0, "N*s/m", 0.5), "e": (1.0, "N")}}
    model = oscillator(
        {"hold": spring("k"), "oil": own, "motor": push("f"), "bias": push("c")},
        {"k": (5.0, "N/m", 0.1), "c": (-1.0, "N", 0.2)},
        inputs={"f": {"unit": "N"}},
    )
    found = dull_hypotheses(with_channels(model))
    assert [(h.kind, h.path, h.positive[0]) for h in found] == [
        ("parameter", "k", True),
        ("parameter", "c", False),
        ("parameter", "oil.d", True),
        ("gain", "f.gain", False),
        ("offset", "f.offset", False),
        ("gain", "place.gain", False),
        ("offset", "place.offset", False),
    ]
    paths = {item.path for item in with_channels(model).all_parameters()}
    assert {h.path for h in found} <= paths
    assert str(found[0]) == "parameter k"


def test_channels_that_state_gain_and_offset_do_not_change_the_machine() -> None:
    inputs = {"f": {"unit": "N", "gain": 1.5}}
    model = oscillator({"motor": push("f")}, inputs=inputs)
    plain, full = build(model), build(with_channels(model))
    assert full.values.size == plain.values.size + 3
    assert full.values[full.column("f.gain")] == 1.5
    for machine in (plain, full):
        assert value(machine.k_e, 0.1, 0.2, 4.0, 0, machine.values) == pytest.approx([6.0])
        y = value(machine.outputs, 0.1, 0.2, 0, 4.0, 0, machine.values)
        assert y == pytest.approx([0.1])


def test_a_found_element_is_written_and_read_like_one_a_person_wrote() -> None:
    model = cart_pole(length="mm", angle="deg")
    hypothesis = Hypothesis(
        "friction", On("phi"), ("coulomb", "static"), (True, True),
        (("stribeck", 0.3), ("transition", 1e-3)), ("stribeck",),
    )  # fmt: skip
    element = hypothesis.element(model, "found_friction", {"coulomb": 0.02, "static": 0.05})
    units = {item.name: item.unit.text for item in element.parameters}
    assert units == {
        "stribeck": "rad/s", "transition": "rad/s", "coulomb": "N*m", "static": "N*m",
    }  # fmt: skip
    corrected = append_elements(model, [element])
    again = parse_model(text_of(corrected)).elements[-1]
    assert {item.name: item.si for item in again.parameters} == pytest.approx(
        {"stribeck": 0.3, "transition": 1e-3, "coulomb": 0.02, "static": 0.05}
    )
    plain, machine = build(model), build(corrected)
    q, v = np.array([0.1, 0.4]), np.array([-0.3, 0.2])
    more = value(machine.k_e, q, v, 0, 0, machine.values) - value(
        plain.k_e, q, v, 0, 0, plain.values
    )
    level = 0.02 + 0.03 * np.exp(-((0.2 / 0.3) ** 2))
    assert more == pytest.approx([0, -level * np.tanh(0.2 / 1e-3)])


def test_probes_are_the_law_in_its_unknown_numbers() -> None:
    """The force of any values is the sum of value times probe, at every place and kind."""
    model = cart_pole()
    speeds = dict.fromkeys(places_of(model), 0.7)
    tried = force_hypotheses(model, speeds)
    book = library(model, places_of(model), tried)
    rng = np.random.default_rng(1)
    q, v, u = rng.normal(size=(6, 2)), rng.normal(size=(6, 2)), rng.normal(size=(6, 1))
    t = np.arange(6.0)
    forces = book.forces(q, v, u, t)
    assert forces.shape == (6, 2, sum(len(h.terms) for h in tried))
    for hypothesis, columns in zip(tried, book.columns, strict=True):
        values = dict(zip(hypothesis.terms, rng.uniform(0.5, 2, len(columns)), strict=True))
        element = hypothesis.element(model, "it", values)
        machine = build(replace(model, elements=(*model.elements, element)))
        for i in range(6):
            alone = value(machine.elements, q[i], v[i], u[i], t[i], machine.values)[-1]
            combined = forces[i][:, list(columns)] @ list(values.values())
            assert combined == pytest.approx(alone, rel=1e-12, abs=1e-14), str(hypothesis)


def test_a_library_knows_how_its_places_move_and_push() -> None:
    model = cart_pole()
    places = places_of(model)
    book = library(model, places, force_hypotheses(model, dict.fromkeys(places, 0.7)))
    rng = np.random.default_rng(2)
    q, v = rng.normal(size=(5, 2)), rng.normal(size=(5, 2))
    u, t = np.zeros((5, 1)), np.arange(5.0)
    stretch, rate = book.motion(q, v, t)
    a = 0.3
    dx, dy = q[:, 0] + 2 * a * np.sin(q[:, 1]) - 1.5 * a, 2 * a * (1 - np.cos(q[:, 1]))
    assert stretch[:, :2] == pytest.approx(q)
    assert stretch[:, 2] == pytest.approx(np.hypot(dx, dy))
    assert rate[:, :2] == pytest.approx(v)
    push_on = book.directions(q, v, u, t)
    assert push_on[:, :, 0] == pytest.approx(np.tile([1.0, 0.0], (5, 1)))
    assert push_on[:, :, 1] == pytest.approx(np.tile([0.0, 1.0], (5, 1)))
    # a tension pulls the points together: its power is −rate
    assert np.einsum("ni,ni->n", push_on[:, :, 2], v) == pytest.approx(-rate[:, 2])


def test_a_library_without_hypotheses_still_knows_its_places() -> None:
    model = oscillator({"hold": spring("k")}, {"k": (5.0, "N/m")})
    book = library(model, (On("x"),), ())
    q = v = np.linspace(0, 1, 4)[:, None]
    assert book.forces(q, v, np.empty((4, 0)), q[:, 0]).shape == (4, 1, 0)
    assert book.motion(q, v, q[:, 0])[0] == pytest.approx(q)


def test_the_natural_length_is_that_of_the_spring_there() -> None:
    assert natural_length(cart_pole(), BAND) == pytest.approx(0.35)


def test_without_a_spring_the_natural_length_is_the_distance_at_the_start() -> None:
    """The tip hangs 0.6 m below the cart, the post stands at (0.45, −0.6)."""
    model = cart_pole()
    bare = replace(model, elements=tuple(e for e in model.elements if e.name != "band"))
    assert natural_length(bare, BAND) == pytest.approx(0.45)


def test_hypotheses_are_said_in_words() -> None:
    tried = force_hypotheses(cart_pole(), {BAND: 1.0})
    assert str(tried[0]) == "constant (constant) between post and tip"
    assert str(tried[-1]) == "friction (coulomb, static) between post and tip"
