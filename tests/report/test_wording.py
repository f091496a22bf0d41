"""Numbers, units and sentences: what an engineer would sign."""

import math

import pytest

from symhyb.discrepancy.results import Alternative, Estimate, Found, Measurement, Reestimated
from symhyb.discrepancy.words.wording import (
    alternative_phrase,
    effect_phrase,
    effect_sentence,
    joined,
    measurement_phrase,
    number_text,
    percent_text,
    quantity_text,
    small_text,
    unit_text,
    verdict_sentence,
)
from symhyb.model.types import At, Between, Element, On, Place
from symhyb.model.vocabulary import KINDS
from symhyb.report.contract import _alternative

NAN, INFINITE = math.nan, math.inf


@pytest.mark.parametrize(
    ("value", "sd", "text"),
    [
        (20.3456, 0.2345, "20.3 ± 0.2"),
        (203.5034, 1.34, "203.5 ± 1.3"),
        (0.4213, 0.031, "0.42 ± 0.03"),
        (20.41, 0.0996, "20.41 ± 0.10"),  # rounds to a first digit of 1
        (20.41, 0.195, "20.4 ± 0.2"),  # rounds to a first digit of 2
        (20.3, 0.96, "20.3 ± 1.0"),  # the place was chosen before rounding
        (203512.0, 1340.0, "203500 ± 1300"),
        (-3.1648, 0.06, "−3.16 ± 0.06"),
        (0.0, 0.2, "0.0 ± 0.2"),
        (-0.01, 0.2, "0.0 ± 0.2"),  # no minus zero
        (0.3, 26.0, "0 ± 30"),
        (1.234e-5, 2.1e-7, "(1.23 ± 0.02)·10⁻⁵"),
        (1.23e9, 1.2e7, "(1.230 ± 0.012)·10⁹"),
        (20.3456, None, "20.35"),
        (20.3456, NAN, "20.35"),
        (20.3456, INFINITE, "20.35"),
        (20.3456, 0.0, "20.35"),
        (20.3456, 1e-12, "20.35"),
        (980.0, None, "980"),
        (0.001, None, "0.001"),
        (9.99996, None, "10"),
        (123456.0, None, "123500"),
        (1.5e-7, None, "1.5·10⁻⁷"),
        (0.0, None, "0"),
        (NAN, 0.1, "not known"),
        (None, None, "not known"),
    ],
)
def test_number_carries_the_digits_that_are_known(
    value: float | None, sd: float | None, text: str
) -> None:
    assert number_text(value, sd) == text


@pytest.mark.parametrize(
    ("unit", "text"),
    [
        ("N*s^2/m^2", "N·s²/m²"),
        ("N/m^3", "N/m³"),
        ("s^-1", "s⁻¹"),
        ("m^10", "m¹⁰"),
        ("m^0.5", "m^0.5"),
        ("m^(1/2)", "m^(1/2)"),
        ("1", ""),
        ("rad", "rad"),
    ],
)
def test_unit_reads_as_in_print(unit: str, text: str) -> None:
    assert unit_text(unit) == text


def test_quantity_joins_number_and_unit() -> None:
    assert quantity_text(20.3456, "N", 0.2345) == "20.3 ± 0.2 N"
    assert quantity_text(1.05, "1", 0.013) == "1.050 ± 0.013"
    assert quantity_text(NAN, "N") == "not known"


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.871, "87 %"),
        (0.0432, "4.3 %"),
        (0.00521, "0.52 %"),
        (0.9962, "99.6 %"),
        (0.9999, "more than 99.9 %"),
        (1.0, "100 %"),
        (1.234, "123 %"),
        (0.0, "0 %"),
        (3e-6, "less than 0.01 %"),
        (NAN, "not known"),
        (None, "not known"),
    ],
)
def test_percent_never_rounds_to_all_or_nothing(share: float | None, text: str) -> None:
    assert percent_text(share) == text


def test_lists_read_as_sentences_do() -> None:
    assert [joined("A"), joined("AB"), joined("ABC")] == ["A", "A and B", "A, B and C"]
    assert joined("AB", "or") == "A or B"
    assert joined([]) == ""


COULOMB = Estimate("F_c", 20.41, 0.2, "N", "coulomb")
DAMPING = Estimate("b", 203.5, 1.34, "N*s/m", "damping")


@pytest.mark.parametrize(
    ("kind", "place", "estimates", "share", "sentence"),
    [
        (
            "friction",
            On("x"),
            [COULOMB, Estimate("v", 0.0123, 0.0021, "m/s", "transition")],
            0.871,
            "On x, dry (Coulomb) friction of 20.4 ± 0.2 N that turns over within 0.012 ± 0.002 m/s "
            "of rest resists the motion; without it 87 % of the squared error on unseen data comes "
            "back.",
        ),
        (
            "damper",
            On("phi"),
            [Estimate("d", 0.31, 0.02, "N*m*s/rad", "damping")],
            None,
            "On phi, viscous damping of 0.31 ± 0.02 N·m·s/rad resists the rotation.",
        ),
        (
            "friction",
            On("phi"),
            [Estimate("d", 0.31, 0.02, "N*m", "coulomb")],
            -0.01,
            "On phi, dry (Coulomb) friction torque of 0.31 ± 0.02 N·m resists the rotation; "
            "without it the squared error on unseen data does not grow.",
        ),
        (
            "drag",
            Between("anchor", "tip"),
            [Estimate("d", 0.8, 0.03, "N*s^2/m^2", "drag")],
            1.5,
            "Between anchor and tip, drag quadratic in speed (0.80 ± 0.03 N·s²/m²) resists the "
            "relative motion; without it the squared error on unseen data grows by 1.5 times what "
            "it was uncorrected.",
        ),
        (
            "spring",
            On("x"),
            [Estimate("c", 1200.0, 30.0, "N/m^3", "cubic")],
            None,
            "On x, cubic stiffness of 1200 ± 30 N/m³ (hardening) acts.",
        ),
        (
            "spring",
            On("x"),
            [
                Estimate("k", -3.0, 0.3, "N/m", "stiffness"),
                Estimate("c", -9.0, 3.0, "N/m^3", "cubic"),
            ],
            None,
            "On x, linear stiffness of −3.0 ± 0.3 N/m (pushes away from rest) and cubic stiffness "
            "of −9 ± 3 N/m³ (softening) act.",
        ),
        (
            "constant",
            On("q"),
            [Estimate("c", -3.16, 0.06, "N", "constant")],
            None,
            "On q, a constant force of −3.16 ± 0.06 N acts towards negative q.",
        ),
        (
            "constant",
            On("phi"),
            [Estimate("c", 3.16, 0.06, "N*m", "constant")],
            None,
            "On phi, a constant torque of 3.16 ± 0.06 N·m acts towards positive phi.",
        ),
        (
            "constant",
            Between("a", "b"),
            [Estimate("c", 3.16, 0.06, "N", "constant")],
            None,
            "Between a and b, a constant force of 3.16 ± 0.06 N acts, pulling the two points "
            "together.",
        ),
        (
            "damper",
            On("x"),
            [Estimate("b", -2.0, 0.3, "N*s/m", "damping")],
            None,
            "On x, viscous damping of −2.0 ± 0.3 N·s/m drives the motion instead of resisting it.",
        ),
        (
            "added_mass",
            At("tip"),
            [Estimate("m", 0.2, 0.03, "kg", "mass")],
            None,
            "At tip, added mass of 0.20 ± 0.03 kg resists the acceleration.",
        ),
    ],
)
def test_effect_is_said_from_its_numbers(
    kind: str, place: Place, estimates: list[Estimate], share: float | None, sentence: str
) -> None:
    assert effect_sentence(kind, place, estimates, share) == sentence


LEVEL = Estimate("T_c", 0.5, 0.001, "N*m", "coulomb")
TRANSITION = Estimate("v_t", 0.2, 0.01, "rad/s", "transition")


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ([], " that turns over within 0.200 ± 0.010 rad/s of rest"),
        (
            [Estimate("mu", 0.1, 0.01, "1", "load_coefficient")],
            " that turns over within 0.200 ± 0.010 rad/s of rest and grows by 0.100 ± 0.010 of the "
            "load",
        ),
        (
            [Estimate("g_s", 0.3, 0.01, "N*m/rad", "slope")],
            " at 0 rad that changes by 0.300 ± 0.010 N·m/rad along the travel and turns over within"
            " 0.200 ± 0.010 rad/s of rest",
        ),
    ],
)
def test_a_transition_that_was_fitted_is_said(more: list[Estimate], said: str) -> None:
    sentence = effect_sentence("friction", On("phi"), [LEVEL, TRANSITION, *more], None)
    head = "On phi, dry (Coulomb) friction torque of 0.5000 ± 0.0010 N·m"
    assert sentence == f"{head}{said} resists the rotation."


def test_effect_without_numbers_keeps_its_name() -> None:
    assert effect_phrase("friction", []) == "dry (Coulomb) friction"
    assert effect_phrase("gap", []) == "an elastic stop behind a clearance"
    assert effect_phrase("strange_law", []) == "an element of kind strange law"
    assert effect_phrase("friction", [Estimate("F_s", 2.0, 0.1, "N", "static")]) == (
        "dry (Coulomb) friction with breakaway friction 2.00 ± 0.10 N"
    )
    for kind, words in KINDS.items():
        assert effect_sentence(kind, On("x"), []).startswith("On x, ")
        assert words.words.split(" ")[-1].strip("()") in effect_phrase(kind, [])


STIFF = Estimate("k", 900.0, 2.0, "N/m", "stiffness")
CLEARANCE = Estimate("s_c", 0.05, 1e-4, "m", "clearance")
WIDE_STOP = [
    Estimate("k", 40.0, 2.0, "N*m/rad", "stiffness"),
    Estimate("s_c", 0.2, 0.001, "rad", "clearance"),
]
BOUC_WEN = [
    Estimate("k", 120.0, 0.3, "N/m", "stiffness"),
    Estimate("beta", 40.0, 0.4, "1/m", "beta"),
    Estimate("gamma", 20.0, 0.3, "1/m", "gamma"),
]
SQUARE = [
    Estimate("k", 120.0, 0.3, "N*m/rad", "stiffness"),
    Estimate("beta", 80.0, 0.4, "1/rad^2", "beta"),
    Estimate("gamma", 20.0, 0.3, "1/rad^2", "gamma"),
    Estimate("n", 2.0, 0.05, "1", "exponent"),
    Estimate("s_p", 0.05, 0.001, "rad", "play"),
]
SINE = [
    Estimate("F_a", 1.2, 0.01, "N", "amplitude"),
    Estimate("f_0", 3.7, 0.007, "1/s", "frequency"),
    Estimate("phi_0", 0.6, 0.03, "1", "phase"),
]
COGGING = [
    Estimate("F_a", 0.3, 0.01, "N*m", "amplitude"),
    Estimate("l_p", 0.2617994, 2.6e-4, "rad", "period"),
]
LUGRE = [
    Estimate("F_c", 1.2, 0.01, "N", "coulomb"),
    Estimate("k", 300.0, 3.0, "N/m", "stiffness"),
]
STRIBECK = [
    Estimate("F_c", 0.5, 0.01, "N", "coulomb"),
    Estimate("F_s", 1.3, 0.02, "N", "static"),
    Estimate("v_s", 0.1, 0.003, "m/s", "stribeck"),
]
SIDED = [
    Estimate("d", 0.7, 0.01, "N*s/m", "damping"),
    Estimate("a_s", 1 / 7, 0.02, "1", "asymmetry"),
]


@pytest.mark.parametrize(
    ("kind", "place", "estimates", "options", "sentence"),
    [
        (
            "gap",
            On("x"),
            [STIFF, CLEARANCE],
            "upper",
            "On x, an elastic stop of 900 ± 2 N/m acts beyond a clearance of 50.00 ± 0.10 mm on "
            "the upper side.",
        ),
        (
            "gap",
            On("x"),
            [STIFF, CLEARANCE, Estimate("d", 3.0, 0.2, "N*s/m", "damping")],
            "both",
            "On x, an elastic stop of 900 ± 2 N/m acts beyond a clearance of 50.00 ± 0.10 mm on "
            "both sides, 100 mm apart (damping 3.0 ± 0.2 N·s/m).",
        ),
        (
            "gap",
            On("phi"),
            WIDE_STOP,
            "lower",
            "On phi, an elastic stop of 40 ± 2 N·m/rad acts beyond a clearance of 0.2000 ± 0.0010 "
            "rad (11.46 ± 0.06°) on the lower side.",
        ),
        (
            "hysteresis",
            On("x"),
            BOUC_WEN,
            "",
            "On x, hysteresis (Bouc–Wen) resists the motion with a stiffness of 120.0 ± 0.3 N/m "
            "that saturates at about 2 N (beta 40.0 ± 0.4 1/m, gamma 20.0 ± 0.3 1/m).",
        ),
        (
            "hysteresis",
            On("phi"),
            SQUARE,
            "",
            "On phi, hysteresis (Bouc–Wen) resists the rotation with a stiffness of 120.0 ± 0.3 "
            "N·m/rad that saturates at about 6 N·m behind a play of 0.0500 ± 0.0010 rad "
            "(2.86 ± 0.06°) (beta 80.0 ± 0.4 1/rad², gamma 20.0 ± 0.3 1/rad², exponent 2.00 ± "
            "0.05).",
        ),
        (
            "friction_dynamic",
            On("x"),
            LUGRE,
            "",
            "On x, dry friction of 1.200 ± 0.010 N that yields elastically over about 4 mm before "
            "it slides (LuGre) resists the motion, with stiffness 300 ± 3 N/m.",
        ),
        (
            "relaxation",
            On("x"),
            [
                Estimate("k", 150.0, 1.4, "N/m", "stiffness"),
                Estimate("d", 15.0, 0.2, "N*s/m", "damping"),
            ],
            "",
            "On x, a spring of 150.0 ± 1.4 N/m that relaxes with the time constant 0.1 s (Maxwell) "
            "acts, with damping 15.0 ± 0.2 N·s/m.",
        ),
        (
            "harmonic",
            On("x"),
            SINE,
            "",
            "On x, a harmonic force of 1.200 ± 0.010 N at 3.700 ± 0.007 Hz acts, with phase "
            "0.60 ± 0.03 rad.",
        ),
        (
            "ripple",
            On("x"),
            [
                Estimate("F_a", 1.5, 0.01, "N", "amplitude"),
                Estimate("l", 0.03, 2e-4, "m", "period"),
                Estimate("phi_0", 0.4, 0.02, "1", "phase"),
            ],
            "",
            "On x, a force of 1.500 ± 0.010 N that repeats every 30.0 ± 0.2 mm of travel acts, "
            "with phase 0.40 ± 0.02 rad.",
        ),
        (
            "ripple",
            On("phi"),
            COGGING,
            "",
            "On phi, a torque of 0.300 ± 0.010 N·m that repeats 24.00 ± 0.02 times a turn "
            "(every 15.000 ± 0.015°) acts.",
        ),
        (
            "added_mass",
            On("phi"),
            [Estimate("m_a", 0.25, 0.02, "kg*m^2", "mass")],
            "",
            "On phi, added inertia of 0.25 ± 0.02 kg·m² (as of a rotor behind a gear) resists the "
            "acceleration.",
        ),
        (
            "added_mass",
            Between("a", "b"),
            [Estimate("m_a", 0.25, 0.02, "kg", "mass")],
            "",
            "Between a and b, added mass of 0.25 ± 0.02 kg resists the relative acceleration.",
        ),
        (
            "friction",
            On("x"),
            STRIBECK,
            "",
            "On x, dry (Coulomb) friction of 0.500 ± 0.010 N (1.30 ± 0.02 N at breakaway, Stribeck "
            "speed 0.100 ± 0.003 m/s) resists the motion.",
        ),
        (
            "damper",
            On("x"),
            SIDED,
            "",
            "On x, viscous damping of 0.700 ± 0.010 N·s/m (0.8 N·s/m forward, 0.6 N·s/m backward) "
            "resists the motion, with asymmetry 0.14 ± 0.02.",
        ),
    ],
)
def test_laws_with_shape_and_memory_are_said_as_an_engineer_would(
    kind: str, place: Place, estimates: list[Estimate], options: str, sentence: str
) -> None:
    words = [("side", options)] if options else []
    assert effect_sentence(kind, place, estimates, None, words) == sentence


def test_a_saturation_is_said_only_where_the_numbers_give_one() -> None:
    assert "saturates" not in effect_phrase("hysteresis", BOUC_WEN[:1])
    opening = [BOUC_WEN[0], Estimate("beta", -40.0, 1.0, "1/m", "beta"), BOUC_WEN[2]]
    assert "saturates" not in effect_phrase("hysteresis", opening)
    held = SQUARE[:3]  # an exponent of 2 that was set: not among the estimates
    assert "saturates" not in effect_phrase("hysteresis", held)


@pytest.mark.parametrize(
    ("value", "unit", "sd", "text"),
    [
        (0.05, "m", 1e-4, "50.00 ± 0.10 mm"),
        (1.5, "m", 0.02, "1.50 ± 0.02 m"),
        (3e-5, "m", None, "30 µm"),
        (0.012, "s", 1e-4, "12.00 ± 0.10 ms"),
        (0.1, "s", None, "0.1 s"),
        (0.0, "m", 1e-4, "(0.0 ± 1.0)·10⁻⁴ m"),
        (0.01, "N", None, "0.01 N"),
        (math.pi / 6, "rad", None, "0.5236 rad (30°)"),
        (NAN, "m", None, "not known"),
    ],
)
def test_small_lengths_and_times_take_the_prefix_that_reads_best(
    value: float, unit: str, sd: float | None, text: str
) -> None:
    assert small_text(value, unit, sd) == text


def found(kind: str, place: Place, *estimates: Estimate) -> Found:
    return Found(Element("found", kind, place, ()), "", estimates, None, "")


def test_missing_physics_is_grouped_by_place() -> None:
    tip = Between("anchor", "tip")
    effects = (
        found("friction", On("x"), COULOMB),
        found("drag", tip),
        found("damper", On("x"), DAMPING),
    )
    assert verdict_sentence("missing physics", effects) == (
        "On x the model lacks dry (Coulomb) friction of 20.4 ± 0.2 N and viscous damping of "
        "203.5 ± 1.3 N·s/m; between anchor and tip it lacks drag quadratic in speed."
    )


def test_long_phrases_are_numbered() -> None:
    stop = Found(
        Element("found", "gap", On("x"), (), options=(("side", "upper"),)),
        "",
        (STIFF, CLEARANCE),
        None,
        "",
    )
    effects = (stop, found("damper", On("x"), DAMPING), found("friction", On("y"), *STRIBECK))
    assert verdict_sentence("missing physics", effects) == (
        "On x the model lacks (1) an elastic stop of 900 ± 2 N/m beyond a clearance of "
        "50.00 ± 0.10 mm on the upper side and (2) viscous damping of 203.5 ± 1.3 N·s/m; on y it "
        "lacks dry (Coulomb) friction of 0.500 ± 0.010 N (1.30 ± 0.02 N at breakaway, Stribeck "
        "speed 0.100 ± 0.003 m/s)."
    )
    rivals = [
        Alternative(None, "gap", (STIFF,), 0.0, place=On("x"), options=(("side", side),))
        for side in ("upper", "both")
    ]
    assert verdict_sentence("undecided", alternatives=rivals).endswith(
        "an elastic stop of 900 ± 2 N/m on the upper side on x or an elastic stop of 900 ± 2 N/m "
        "on both sides on x."
    )


def test_delays_say_who_is_late() -> None:
    late = Measurement("f", "delay", 0.012, 1e-4, "s")
    assert measurement_phrase(late) == "f arrives 12.00 ± 0.10 ms late"
    early = Measurement("laser", "delay", -0.002, 1e-4, "s")
    assert measurement_phrase(early) == "laser arrives 2.00 ± 0.10 ms early"


def test_what_else_was_found_follows_the_verdict() -> None:
    changed = (Reestimated("k", 980.0, 1012.3, 5.2, "N/m"),)
    faults = (Measurement("laser", "offset", 0.0021, 0.0003, "m"),)
    offset = "laser has an offset of 0.0021 ± 0.0003 m"
    value = "k = 1012 ± 5 N/m (the model said 980 N/m)"
    said = verdict_sentence("missing physics", [found("damper", On("x"))], changed, faults)
    assert said == f"On x the model lacks viscous damping. Besides, {offset} and {value}."
    assert verdict_sentence("measurement", (), changed, faults) == (
        f"The physics of the model holds, the measurement does not: {offset}. Besides, {value}."
    )
    assert verdict_sentence("parameters", (), changed) == (
        f"The model lacks no physics, but its numbers are off: {value}."
    )


def test_undecided_names_the_rivals_or_says_that_there_are_none() -> None:
    rivals = (
        Alternative(None, "damper", (DAMPING,), 0.0, place=On("x")),
        Alternative(None, "delay", (Estimate("t", 2e-3, 1e-4, "s", "delay"),), 1.0, channel="f"),
        Alternative(None, "offset", (), 1.0, channel="f"),
        Alternative(None, "parameter", (), 1.0, parameter="k"),
    )
    said = verdict_sentence("undecided", alternatives=rivals)
    assert said.endswith(
        "cannot tell the causes apart: viscous damping of 203.5 ± 1.3 N·s/m on x, "
        "a delay of 2.00 ± 0.10 ms in channel f or an offset in channel f."
    )
    assert alternative_phrase(rivals[3]) == "parameter k"
    assert "no cause that symhyb knows" in verdict_sentence("undecided")


def test_parts_of_the_best_structure_without_a_rival_are_in_doubt_together() -> None:
    dry = Estimate("F_c", 2.0, 0.1, "N", "coulomb")
    drag = Estimate("d", 0.4, 0.1, "N*s^2/m^2", "drag")
    both = [
        Alternative(None, "drag", (drag,), 0.0, place=On("x"), together=1),
        Alternative(None, "friction", (dry,), 0.0, place=On("x"), together=1),
    ]
    assert verdict_sentence("undecided", alternatives=both) == (
        "Model and recordings differ by more than the noise, but what fits best is in doubt: drag"
        " quadratic in speed (0.40 ± 0.10 N·s²/m²) on x and dry (Coulomb) friction of"
        " 2.00 ± 0.10 N on x together."
    )


def test_causes_that_hold_only_together_are_one_alternative() -> None:
    drag = Estimate("b", 0.4, 0.1, "N*s^2/m^2", "drag")
    dry = Estimate("R", 2.0, 0.1, "N", "coulomb")
    rivals = (
        Alternative(None, "damper", (DAMPING,), 0.0, place=On("x")),
        Alternative(None, "drag", (drag,), 1.0, place=On("x"), together=1),
        Alternative(None, "friction", (dry,), 1.0, place=On("x"), together=1),
    )
    assert verdict_sentence("undecided", alternatives=rivals).endswith(
        "(1) viscous damping of 203.5 ± 1.3 N·s/m on x or (2) drag quadratic in speed "
        "(0.40 ± 0.10 N·s²/m²) on x and dry (Coulomb) friction of 2.00 ± 0.10 N on x together."
    )
    reported = [_alternative(rival) for rival in rivals]
    assert [row.get("together") for row in reported] == [None, 1, 1]


def test_nothing_missing_says_so() -> None:
    assert verdict_sentence("nothing missing").startswith("Nothing is missing")
