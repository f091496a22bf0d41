"""Known values stand in place of those of the model, wherever a recording is met."""

import numpy as np
import pytest

from symhyb.model.read import parse_model
from symhyb.numeric.lowered.known import machine_with, with_known
from symhyb.numeric.lowered.machine import build
from tests.known_weights import PENDULUM


@pytest.fixture(scope="module")
def machine():
    return build(parse_model(PENDULUM))


def test_what_is_known_takes_the_place_of_a_value(machine):
    p = machine.values + 1
    full = with_known(machine, p, {"m": 0.7, "l": 0.2})
    assert full[machine.column("m")] == 0.7
    assert full[machine.column("l")] == 0.2
    others = [i for i in range(p.size) if i not in (machine.column("m"), machine.column("l"))]
    np.testing.assert_array_equal(full[others], p[others])
    assert p[machine.column("m")] == machine.values[machine.column("m")] + 1  # untouched


def test_nothing_known_changes_nothing(machine):
    assert with_known(machine, machine.values, {}) is machine.values
    assert machine_with(machine, {}) is machine


def test_a_machine_with_known_values_has_the_mass_that_they_make(machine):
    heavy = machine_with(machine, {"m": 2.0, "l": 0.5})
    (mass,) = (np.array(heavy.M(np.zeros(1), 0.0, heavy.values)),)
    assert mass[0, 0] == pytest.approx(2.0 * 0.5**2)
    assert heavy.acceleration is machine.acceleration  # functions are shared
