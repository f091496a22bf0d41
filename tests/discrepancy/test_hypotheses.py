"""Hypotheses are ordinary elements: their probes add up, act where they say, and read back."""

from dataclasses import replace

import numpy as np
import pytest
from builders import cart_pole, damper, oscillator, push, spring, value

from symhyb.discrepancy.places import hypotheses
from symhyb.discrepancy.places.candidates import force_hypotheses
from symhyb.discrepancy.places.hypotheses import (
    Hypothesis,
    Library,
    library,
    natural_length,
    parametric_hypotheses,
    places_of,
    with_channels,
)
from symhyb.discrepancy.recorded.course import Course
from symhyb.laws.friction import STRIBECK_SHARES, WIDE_SHARES
from symhyb.laws.reach import TRANSITION_SHARE, Reach
from symhyb.model.read import parse_model
from symhyb.model.types import Between, Model, On, Place
from symhyb.model.vocabulary import KINDS
from symhyb.model.write import append_elements, text_of
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.inner import inner_along
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.units import parse_unit

BAND = Between("post", "tip")
T = np.linspace(0, 4, 401)
PAIRED = {kind for kind, law in KINDS.items() if law.coupling is not None}  # test_pair_laws.py


def reach(speed: float, centre: float = 0.0, force: np.ndarray | None = None) -> Reach:
    """A place that swings with this largest rate about its centre, at 0.5 Hz."""
    w = np.pi
    stretch, rate = centre + speed / w * np.sin(w * T), speed * np.cos(w * T)
    return Reach(stretch, rate, np.zeros(T.size) if force is None else force, T)


def swinging(model: Model, tried: Library | None = None) -> tuple[Machine, Course]:
    """A smooth course of the cart and pole (or of a library on it), its inner states along it."""
    machine = build(model) if tried is None else tried.machine
    q = np.stack([0.2 * np.sin(3 * T), 0.5 * np.sin(2 * T) + 0.3 * np.cos(5 * T)], axis=1)
    v = np.stack([0.6 * np.cos(3 * T), np.cos(2 * T) - 1.5 * np.sin(5 * T)], axis=1)
    a = np.stack([-1.8 * np.sin(3 * T), -2 * np.sin(2 * T) - 7.5 * np.cos(5 * T)], axis=1)
    u, form = np.cos(T)[:, None], state_form(machine)
    z = inner_along(machine, T, (q, v, a), u, machine.values)
    drive = form.driven(u, q, v, a)
    return machine, Course(T, q, v, a, z, u, form.state(q, v, z), drive, np.zeros_like(q))


def test_places_are_coordinates_and_the_pairs_that_elements_join() -> None:
    assert places_of(cart_pole()) == (On("x"), On("phi"), BAND)


def test_one_coordinate_is_one_place() -> None:
    """A pair of points that moves with the only coordinate adds nothing but a geometry."""
    bar = {"kind": "spring", "between": ["wall", "block"], "stiffness": "k"}
    assert places_of(oscillator({"bar": bar}, {"k": (5.0, "N/m")})) == (On("x"),)


def test_every_law_of_the_vocabulary_is_tried_at_every_place() -> None:
    tried = force_hypotheses(
        cart_pole(),
        {
            On("x"): reach(0.5, force=0.3 * np.sin(40 * T)),
            BAND: reach(2.0, 0.35, force=0.3 * np.sin(40 * T)),
        },
    )
    laws = (
        set(KINDS)
        - PAIRED
        - {
            "curve",
            "map",
            "force",
            "torque",
            "law",
            "network",
            "payload",
            "added_inertia",
            "play",  # beside a spring of the model
            "flow_drag",  # in a flow that was recorded
            "flow_lift",
            "mode",
            "hydromount",
        }
    )
    for place in (On("x"), BAND):
        mine = [h for h in tried if h.place == place]
        assert laws - {h.kind for h in mine} <= {"ripple"}
        springs = [h.terms for h in mine if h.kind == "spring"]
        assert springs == [("stiffness",), ("quadratic",), ("cubic",)]
        assert {h.options for h in mine if h.kind == "gap"} == {
            (("side", side),) for side in ("both", "upper", "lower")
        }
    assert len({(h.family, h.shape) for h in tried}) == len(tried)
    for h in tried:
        dissipative = KINDS[h.kind].energy == "dissipative"
        assert h.positive[0] == (dissipative or h.kind in ("added_mass", "play"))
        assert h.numbers == len(h.keys)


def test_friction_scales_with_the_speed_of_its_place() -> None:
    all_tried = force_hypotheses(cart_pole(), {On("x"): reach(0.5)})
    tried = [h for h in all_tried if h.kind == "friction" and not h.bent]
    speed = reach(0.5).speed
    assert speed == pytest.approx(0.5, rel=1e-3)
    wide = [h for h in all_tried if h.kind == "friction" and h.bent]
    assert [h.shape for h in wide] == [(("transition", speed * s),) for s in WIDE_SHARES]
    assert [h.limits("transition") for h in wide] == [(TRANSITION_SHARE * speed, speed)] * 2
    assert [dict(h.shape)["transition"] for h in tried] == [TRANSITION_SHARE * speed] * 3
    assert [dict(h.shape)["stribeck"] for h in tried[1:]] == [speed * s for s in STRIBECK_SHARES]
    assert [h.refined for h in tried] == [(), ("stribeck",), ("stribeck",)]
    assert tried[1].family == tried[2].family != tried[0].family


def test_a_place_that_never_moves_loses_no_energy() -> None:
    tried = force_hypotheses(cart_pole(), {On("x"): reach(0.0)})
    assert {h.kind for h in tried} == {"constant", "spring"}


def test_parametric_causes_are_parameters_with_sd_and_every_channel() -> None:
    own = {**damper("d"), "parameters": {"d": (3.0, "N*s/m", 0.5), "e": (1.0, "N")}}
    model = oscillator(
        {"hold": spring("k"), "oil": own, "motor": push("f"), "bias": push("c")},
        {"k": (5.0, "N/m", 0.1), "c": (-1.0, "N", 0.2)},
        inputs={"f": {"unit": "N"}},
    )
    found = parametric_hypotheses(with_channels(model))
    assert [(h.kind, h.path, h.positive[0]) for h in found] == [
        ("parameter", "k", True),
        ("parameter", "c", False),
        ("parameter", "oil.d", True),
        ("gain", "f.gain", False),
        ("offset", "f.offset", False),
        ("delay", "f.delay", False),
        ("gain", "place.gain", False),
        ("offset", "place.offset", False),
        ("delay", "place.delay", False),
    ]
    paths = {item.path for item in with_channels(model).all_parameters()}
    assert {h.path for h in found} <= paths
    assert str(found[0]) == "parameter k"


def test_channels_that_state_gain_and_offset_do_not_change_the_machine() -> None:
    inputs = {"f": {"unit": "N", "gain": 1.5}}
    model = oscillator({"motor": push("f")}, inputs=inputs)
    plain, full = build(model), build(with_channels(model))
    assert full.values.size == plain.values.size + 5
    assert full.values[full.column("f.gain")] == 1.5
    for machine in (plain, full):
        assert value(machine.k_e, 0.1, 0.2, [], 4.0, 0, machine.values) == pytest.approx([6.0])
        y = value(machine.outputs, 0.1, 0.2, 0, [], 4.0, 0, machine.values)
        assert y == pytest.approx([0.1])


def test_a_found_element_is_written_and_read_like_one_a_person_wrote() -> None:
    model = cart_pole(length="mm", angle="deg")
    hypothesis = Hypothesis(
        "friction",
        On("phi"),
        ("coulomb", "static"),
        (True, True),
        (("stribeck", 0.3), ("transition", 1e-3)),
        ("stribeck",),
    )
    element = hypothesis.element(model, "found_friction", {"coulomb": 0.02, "static": 0.05})
    units = {item.name: item.unit.text for item in element.parameters}
    assert units == {
        "stribeck": "rad/s",
        "transition": "rad/s",
        "coulomb": "N*m",
        "static": "N*m",
    }
    corrected = append_elements(model, [element])
    again = parse_model(text_of(corrected)).elements[-1]
    assert {item.name: item.si for item in again.parameters} == pytest.approx(
        {"stribeck": 0.3, "transition": 1e-3, "coulomb": 0.02, "static": 0.05}
    )
    plain, machine = build(model), build(corrected)
    q, v = np.array([0.1, 0.4]), np.array([-0.3, 0.2])
    more = value(machine.k_e, q, v, [], 0, 0, machine.values) - value(
        plain.k_e, q, v, [], 0, 0, plain.values
    )
    level = 0.02 + 0.03 * np.exp(-((0.2 / 0.3) ** 2))
    assert more == pytest.approx([0, -level * np.tanh(0.2 / 1e-3)])


def everything() -> tuple[Hypothesis, ...]:
    """All that is tried on the cart and pole, periodic laws in time and in place included."""
    places: dict[Place, Reach] = {
        place: reach(1.5, centre, 0.3 * np.sin(40 * T))
        for place, centre in ((On("x"), 0.0), (On("phi"), 0.0), (BAND, 0.5))
    }
    ripple = Hypothesis(
        "ripple", On("phi"), ("sine", "cosine"), (False, False), (("period", 0.21),), ("period",)
    )
    shape = (("frequency", 2.0), ("damping_ratio", 0.05))
    mode = Hypothesis("mode", On("x"), ("mass",), (True,), shape, ("frequency", "damping_ratio"))
    keys = ("mass", "damping")
    track = Hypothesis(
        "hydromount",
        On("x"),
        ("stiffness",),
        (True,),
        (("mass", 0.01), ("damping", 0.03)),
        keys,
        tied=keys,
    )
    return (*force_hypotheses(cart_pole(), places), ripple, mode, track)


@pytest.mark.slow
def test_probes_are_the_law_in_its_unknown_numbers() -> None:
    """The force of any values is the sum of value times probe, at every place and kind, what
    remembers and what has mass included."""
    model, tried = cart_pole(), everything()
    book = library(model, places_of(model), tried)
    _, course = swinging(model, book)
    forces = book.forces(course)
    assert forces.shape == (T.size, 2, sum(len(h.terms) for h in tried))
    rng = np.random.default_rng(1)
    kinds = set()
    for hypothesis, columns in zip(tried, book.columns, strict=True):
        coefficients = np.array([rng.uniform(1, 2), *rng.uniform(0.2, 0.8, len(columns) - 1)])
        element = hypothesis.element(model, "it", hypothesis.values(coefficients))
        machine, alone = swinging(replace(model, elements=(*model.elements, element)))
        c, p = alone, machine.values
        (exact,) = along(machine.elements, (c.q, c.v, c.z, c.u, c.t, p), (5,), T.size)
        exact = exact + along(machine.carried, (c.q, c.v, c.a, c.t, p), (4,), T.size)[0]
        last = exact.reshape(T.size, -1, 2)[:, -1]
        size = np.abs(last).max()
        assert size > 0 or hypothesis.kind == "gap", str(hypothesis)
        combined = forces[:, :, list(columns)] @ coefficients
        assert combined == pytest.approx(last, rel=1e-9, abs=1e-9 * (size + 1)), str(hypothesis)
        kinds.add(hypothesis.kind)
    assert kinds == set(KINDS) - PAIRED - {
        "curve",
        "map",
        "force",
        "torque",
        "law",
        "network",
        "payload",
        "added_inertia",
        "flow_drag",
        "flow_lift",
    }


def test_limits_keep_shapes_near_where_they_were_tried() -> None:
    for hypothesis in everything():
        stiffness = 25.0 if hypothesis.kind == "play" else 1.0  # that of the spring of the model
        first = [stiffness, *[1.0] * (len(hypothesis.terms) - 1)]
        for key, number in hypothesis.values(first).items():
            low, high = hypothesis.limits(key)
            assert low <= number <= high, (str(hypothesis), key)
        assert set(hypothesis.values(first)) == set(hypothesis.keys)
        for key, positive in zip(hypothesis.terms, hypothesis.positive, strict=True):
            if key in hypothesis.keys and key != "skew":
                assert (hypothesis.limits(key)[0] >= 0) == positive


def test_a_library_knows_how_its_places_move_and_push() -> None:
    model = cart_pole()
    places = places_of(model)
    book = library(model, places, everything())
    _, course = swinging(model, book)
    q, v = course.q, course.v
    stretch, rate = book.motion(course)
    a = 0.3
    dx, dy = q[:, 0] + 2 * a * np.sin(q[:, 1]) - 1.5 * a, 2 * a * (1 - np.cos(q[:, 1]))
    assert stretch[:, :2] == pytest.approx(q)
    assert stretch[:, 2] == pytest.approx(np.hypot(dx, dy))
    assert rate[:, :2] == pytest.approx(v)
    push_on = book.directions(course)
    assert push_on[:, :, 0] == pytest.approx(np.tile([1.0, 0.0], (T.size, 1)))
    assert push_on[:, :, 1] == pytest.approx(np.tile([0.0, 1.0], (T.size, 1)))
    # a tension pulls the points together: its power is −rate
    assert np.einsum("ni,ni->n", push_on[:, :, 2], v) == pytest.approx(-rate[:, 2])


def test_forces_and_motion_of_pieces_are_those_of_the_whole(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = cart_pole()
    book = library(model, places_of(model), everything())
    _, course = swinging(model, book)
    rows = np.array([[3, 4, 5], [10, 11, 12]])
    for whole, part in zip(book.motion(course), book.motion(course, rows), strict=True):
        assert part == pytest.approx(whole[rows], rel=1e-12)
    forces = book.forces(course)
    monkeypatch.setattr(hypotheses, "CHUNK", 16)
    hypotheses._forces_along.cache_clear()
    assert book.forces(course) == pytest.approx(forces, rel=1e-12, abs=1e-12)


def test_a_library_without_hypotheses_still_knows_its_places() -> None:
    model = cart_pole()
    book = library(model, (On("x"),), ())
    _, course = swinging(model, book)
    assert book.forces(course).shape == (T.size, 2, 0)
    assert book.motion(course)[0] == pytest.approx(course.q[:, :1])


def test_the_natural_length_is_that_of_the_spring_there() -> None:
    assert natural_length(cart_pole(), BAND) == pytest.approx(0.35)


def test_without_a_spring_the_natural_length_is_the_distance_at_the_start() -> None:
    """The tip hangs 0.6 m below the cart, the post stands at (0.45, −0.6)."""
    model = cart_pole()
    bare = replace(model, elements=tuple(e for e in model.elements if e.name != "band"))
    assert natural_length(bare, BAND) == pytest.approx(0.45)


def test_hypotheses_are_said_in_words() -> None:
    tried = force_hypotheses(cart_pole(), {BAND: reach(1.0, 0.35)})
    said = [str(h) for h in tried]
    assert said[0] == "constant (constant) between post and tip"
    assert "friction (coulomb, static, stribeck) between post and tip" in said
    assert "gap (side upper, stiffness, clearance) between post and tip" in said


def test_the_coefficient_of_a_formula_has_the_unit_that_makes_it_a_force() -> None:
    model = cart_pole()
    place = On(model.coordinates[0].name)
    formula = f"{place.coordinate}'**3"
    unit = Hypothesis("law", place, ("coefficient",), (True,), path=formula).unit(
        model, "coefficient"
    )
    assert unit.factor == 1.0
    assert unit * parse_unit("m^3/s^3") == parse_unit("N")
    assert Hypothesis("damper", place, ("damping",), (True,)).unit(model, "damping").text == "N*s/m"
