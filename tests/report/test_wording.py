"""Numbers, units and sentences: what an engineer would sign."""

import math

import pytest

from symhyb.discrepancy.results import Alternative, Estimate, Found, Measurement, Reestimated
from symhyb.discrepancy.wording import (
    alternative_phrase,
    effect_phrase,
    effect_sentence,
    joined,
    number_text,
    percent_text,
    quantity_text,
    unit_text,
    verdict_sentence,
)
from symhyb.model.types import At, Between, Element, On, Place

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
            "friction", On("x"), [COULOMB, Estimate("v", 0.0123, 0.0021, "m/s", "transition")],
            0.871,
            "On x, dry (Coulomb) friction of 20.4 ± 0.2 N resists the motion, with transition "
            "speed 0.012 ± 0.002 m/s; without it 87 % of the squared error on unseen data comes "
            "back.",
        ),
        (
            "damper", On("phi"), [Estimate("d", 0.31, 0.02, "N*m*s/rad", "damping")], None,
            "On phi, viscous damping of 0.31 ± 0.02 N·m·s/rad resists the rotation.",
        ),
        (
            "friction", On("phi"), [Estimate("d", 0.31, 0.02, "N*m", "coulomb")], -0.01,
            "On phi, dry (Coulomb) friction torque of 0.31 ± 0.02 N·m resists the rotation; "
            "without it the squared error on unseen data does not grow.",
        ),
        (
            "drag", Between("anchor", "tip"), [Estimate("d", 0.8, 0.03, "N*s^2/m^2", "drag")], 1.5,
            "Between anchor and tip, drag quadratic in speed (0.80 ± 0.03 N·s²/m²) resists the "
            "relative motion; without it the squared error on unseen data grows by 1.5 times what "
            "it was uncorrected.",
        ),
        (
            "spring", On("x"), [Estimate("c", 1200.0, 30.0, "N/m^3", "cubic")], None,
            "On x, cubic stiffness of 1200 ± 30 N/m³ (hardening) acts.",
        ),
        (
            "spring", On("x"),
            [
                Estimate("k", -3.0, 0.3, "N/m", "stiffness"),
                Estimate("c", -9.0, 3.0, "N/m^3", "cubic"),
            ],
            None,
            "On x, linear stiffness of −3.0 ± 0.3 N/m (pushes away from rest) and cubic stiffness "
            "of −9 ± 3 N/m³ (softening) act.",
        ),
        (
            "constant", On("q"), [Estimate("c", -3.16, 0.06, "N", "constant")], None,
            "On q, a constant force of −3.16 ± 0.06 N acts towards negative q.",
        ),
        (
            "constant", On("phi"), [Estimate("c", 3.16, 0.06, "N*m", "constant")], None,
            "On phi, a constant torque of 3.16 ± 0.06 N·m acts towards positive phi.",
        ),
        (
            "constant", Between("a", "b"), [Estimate("c", 3.16, 0.06, "N", "constant")], None,
            "Between a and b, a constant force of 3.16 ± 0.06 N acts, pulling the two points "
            "together.",
        ),
        (
            "damper", On("x"), [Estimate("b", -2.0, 0.3, "N*s/m", "damping")], None,
            "On x, viscous damping of −2.0 ± 0.3 N·s/m drives the motion instead of resisting it.",
        ),
        (
            "added_mass", At("tip"), [Estimate("m", 0.2, 0.03, "kg", "mass")], None,
            "At tip, an element of kind added mass with mass 0.20 ± 0.03 kg acts.",
        ),
    ],
)  # fmt: skip
def test_effect_is_said_from_its_numbers(
    kind: str, place: Place, estimates: list[Estimate], share: float | None, sentence: str
) -> None:
    assert effect_sentence(kind, place, estimates, share) == sentence


def test_effect_without_numbers_keeps_its_name() -> None:
    assert effect_phrase("friction", []) == "dry (Coulomb) friction"
    assert effect_phrase("gap", []) == "an element of kind gap"


def found(kind: str, place: Place, *estimates: Estimate) -> Found:
    return Found(Element("found", kind, place, ()), "", estimates, None, "")


def test_missing_physics_is_grouped_by_place() -> None:
    tip = Between("anchor", "tip")
    effects = (
        found("friction", On("x"), COULOMB), found("drag", tip), found("damper", On("x"), DAMPING)
    )  # fmt: skip
    assert verdict_sentence("missing physics", effects) == (
        "On x the model lacks dry (Coulomb) friction of 20.4 ± 0.2 N and viscous damping of "
        "203.5 ± 1.3 N·s/m; between anchor and tip it lacks drag quadratic in speed."
    )


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
        "a delay of 0.00200 ± 0.00010 s in channel f or an offset in channel f."
    )
    assert alternative_phrase(rivals[3]) == "parameter k"
    assert "no cause that symhyb knows" in verdict_sentence("undecided")


def test_nothing_missing_says_so() -> None:
    assert verdict_sentence("nothing missing").startswith("Nothing is missing")
