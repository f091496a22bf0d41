"""The reference of kinds says of each what its law says, with a drawing that is its own force."""

import re

import numpy as np
import pytest
from _site.drawing import HEIGHT, WIDTH, axis, drawn, thinned
from _site.kinds import bounds, section, unset
from _site.shown import DRIVES, run, shown

from symhyb.laws import LAWS
from symhyb.laws.base import Law

KINDS = {law.name: law for law in LAWS}


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_every_kind_has_its_law_its_keys_and_its_places(law: Law) -> None:
    text = "\n".join(section(law))
    assert f"F = {law.law}" in text
    assert [key.name for key in law.keys if f"| `{key.name}` |" not in text] == []
    assert [place for place in law.placements if f"`{place}`" not in text] == []


@pytest.mark.slow
def test_every_kind_that_acts_by_itself_is_drawn() -> None:
    written = {"force", "torque", "law", "network"}
    assert DRIVES.keys() == KINDS.keys() - written
    assert all(shown(KINDS[name]) for name in DRIVES)


def test_units_bounds_and_defaults_are_those_of_the_law() -> None:
    text = "\n".join(section(KINDS["damper"]))
    assert "| `damping` | N\\*s/m | N\\*m\\*s/rad | required | ≥ 0 |" in text
    friction = KINDS["friction_dynamic"]
    coulomb, static = friction.key("coulomb"), friction.key("static")
    assert coulomb is not None
    assert static is not None
    assert (bounds(coulomb), unset(friction, static)) == ("> 0", "`coulomb`")


def test_a_spring_is_drawn_as_its_polynomial() -> None:
    law = KINDS["spring"]
    columns, force = run(law, DRIVES["spring"], law.example)
    s, k = columns["s"], law.example
    wanted = k["stiffness"] * s + k["quadratic"] * s**2 + k["cubic"] * s**3
    np.testing.assert_allclose(force, wanted, atol=1e-9)


def test_a_relaxation_closes_its_loop_where_the_linear_law_does() -> None:
    law, drive = KINDS["relaxation"], DRIVES["relaxation"]
    columns, force = run(law, drive, law.example)
    w, k, d = drive.pace, law.example["stiffness"], law.example["damping"]
    response = k * 1j * w * d / (k + 1j * w * d) * drive.stretch  # of a Maxwell element
    wanted = np.imag(response * np.exp(1j * w * columns["t"]))
    # what the start at rest leaves dies out with exp(−k t/d)
    np.testing.assert_allclose(force, wanted, atol=5e-3 * abs(response))


def test_a_drawing_stays_within_its_frame() -> None:
    x = [float(v) for v in np.linspace(-2.0, 3.0, 200)]
    y = [v**3 for v in x]
    svg = drawn(x, y, axis("s", "m", x), axis("F", "N", y), "a <cube>")
    assert "a &lt;cube&gt;" in svg
    assert "3 m" in svg
    assert "27 N" in svg
    (path,) = re.findall(r'<polyline[^>]* points="([^"]+)"', svg)
    places = [tuple(map(float, pair.split(","))) for pair in path.split()]
    assert all(0 < a < WIDTH and 0 < b < HEIGHT for a, b in places)


def test_points_that_nobody_could_see_are_left_out() -> None:
    assert thinned([(0.0, 0.0), (0.1, 0.0), (5.0, 0.0)]) == [(0.0, 0.0), (5.0, 0.0)]
