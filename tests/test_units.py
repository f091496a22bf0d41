"""Units: parsed once, multiplied as text, and read back the same."""

import math
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from symhyb.units import (
    _KNOWN,
    DIMENSIONS,
    ONE,
    Unit,
    UnitError,
    _named,
    _pint_name,
    _registry,
    parse_unit,
)
from symhyb.usual_units import USUAL

MODELS = Path(__file__).resolve().parent.parent / "models"
N, M, S, V, RAD = (parse_unit(text) for text in ("N", "m", "s", "V", "rad"))


@pytest.mark.parametrize("name", USUAL)
def test_usual_units_are_as_pint_has_them(name: str) -> None:
    registry = _registry()
    si = registry.Quantity(1.0, name).to_base_units()
    unit, dimensions = _named(name), dict(si.dimensionality)
    assert unit.factor == pytest.approx(si.magnitude, rel=4e-16, abs=0.0)
    assert unit.dimension == tuple(dimensions.get(key, 0) for key in DIMENSIONS)
    bases = [base for _, base, plural in registry.parse_unit_name(name) if not plural]
    assert _pint_name(name) == next(base for base in bases if base in _KNOWN)


def test_a_file_in_usual_units_does_without_pint() -> None:
    text = "import sys, symhyb as sh; sh.read_model(sys.argv[1]); print('pint' in sys.modules)"
    command = [sys.executable, "-c", text, str(MODELS / "oscillator.toml")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


@pytest.mark.parametrize(
    ("product", "text"),
    [
        (V * V, "V^2"),
        (N / M / M, "N/m^2"),
        (N * S / M, "N*s/m"),
        (N * S / M * S / M, "N*s^2/m^2"),
        (N * M * S / RAD, "N*m*s/rad"),
        (M / M, "1"),
        (ONE / S, "1/s"),
        (N / (M * S), "N/m/s"),
        (RAD * (ONE / RAD), "1"),
        (V ** Fraction(1, 2), "V^(1/2)"),
        (parse_unit("s^2") * V**2 / S**2, "V^2"),
    ],
)
def test_products_stay_readable_and_read_back(product: Unit, text: str) -> None:
    assert product.text == text
    again = parse_unit(text)
    assert again.text == text
    assert again.dimension == product.dimension
    assert again.factor == pytest.approx(product.factor, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "factor"),
    [
        ("1", 1.0),
        ("mm", 1e-3),
        ("N/mm", 1e3),
        ("kHz", 1e3),
        ("deg", math.pi / 180),
        ("rpm", 2 * math.pi / 60),
        ("min", 60.0),
        ("in", 0.0254),
        ("lbf", 4.4482216152605),
        ("kgf", 9.80665),
        ("metric_horsepower", 735.49875),
        ("km^2/h", 1e6 / 3600),
        ("mm^(1/2)", math.sqrt(1e-3)),
        ("N/(m*s)", 1.0),
    ],
)
def test_factor_to_coherent_si(text: str, factor: float) -> None:
    assert parse_unit(text).factor == pytest.approx(factor, rel=1e-12)


def test_dimensions_decide_what_can_be_converted() -> None:
    assert parse_unit("N*m").same_dimension(parse_unit("J"))
    assert parse_unit("kg*m/s^2").same_dimension(N)
    assert not parse_unit("N/m").same_dimension(parse_unit("N*s/m"))


def test_radian_is_a_number_but_stays_in_the_text() -> None:
    assert RAD.is_number
    assert RAD.factor == 1.0
    assert parse_unit("N*m/rad").text == "N*m/rad"
    assert parse_unit("N*m/rad").same_dimension(parse_unit("N*m"))


@pytest.mark.parametrize(
    ("printed", "written"),
    [
        ("m/s²", "m/s^2"),
        ("°", "deg"),
        ("°/s", "deg/s"),
        ("Nm", "N*m"),
        ("kNm", "kN*m"),
        ("Nmm", "N*mm"),
        ("Nms/rad", "N*m*s/rad"),
        ("Ns/m", "N*s/m"),
        ("N s/m", "N*s/m"),
        ("N·m", "N*m"),
        ("kg m²", "kg*m^2"),
        ("rad s⁻¹", "rad/s"),
        ("mN", "mN"),
        ("ms", "ms"),
        ("m/s2", "m/s^2"),
        ("kg-m2", "kg*m^2"),
        ("N-m/rad", "N*m/rad"),
        ("lbf-ft", "lbf*ft"),
        ("m s-2", "m/s^2"),
        ("min-1", "1/min"),
        ("mm3", "mm^3"),
    ],
)
def test_what_data_sheets_print_is_read(printed: str, written: str) -> None:
    assert parse_unit(printed) == parse_unit(written)
    assert parse_unit(printed).text == written


def test_a_degree_of_kelvin_is_a_kelvin() -> None:
    assert parse_unit("°K").factor == 1.0
    assert parse_unit("°K").same_dimension(parse_unit("K"))


def test_angles_are_reported_from_other_numbers() -> None:
    assert all(parse_unit(text).is_angle for text in ("rad", "deg", "mrad", "turn"))
    assert not any(parse_unit(text).is_angle for text in ("1", "rad/s", "rad^2", "mm/m", "m"))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("newtn", "did you mean 'newton'"),
        ("Vs/m", "did you mean 'V*s'"),
        ("Nss", "did you mean 'N*s*s'"),
        ("N/m s", "may be read in two ways"),
        ("°C", "scale with an offset"),
        ("N**2", "power is '^'"),
        ("m²³", "power 23"),
        ("", "unit is empty"),
        ("m*", "ends too early"),
        ("(m", "lacks a ')'"),
        ("m)", "')' is unexpected"),
        ("m^", "needs a number after '^'"),
        ("m^x", "needs a number after '^'"),
        ("m^(1/0)", "over 0"),
        ("m^400", "power 400"),
        ("2*m", "'2' is unexpected"),
        ("m" * 200, "too long"),
        ("k", "not a known unit"),  # Boltzmann's constant in pint
        ("c", "not a known unit"),  # the speed of light
        ("degC", "'x + 273.15 [K]'"),
        ("Grad", "may be a degree in German, or 10^9 radians; write 'deg' or 'rad'"),
        ("m20", "'20' is unexpected"),
        ("m2.5", "'2.5' is unexpected"),
    ],
)
def test_what_is_no_unit_is_refused_with_a_sentence(text: str, sentence: str) -> None:
    with pytest.raises(UnitError) as caught:
        parse_unit(text)
    assert sentence in str(caught.value)


def test_every_unit_that_is_known_can_be_written() -> None:
    names = [*_KNOWN, *_KNOWN.values()]
    assert {name: parse_unit(name).factor > 0 for name in names} == dict.fromkeys(names, True)


def test_units_are_values() -> None:
    assert parse_unit("N/m") == N / M
    assert len({parse_unit("N/m"), N / M}) == 1
