"""The section of the first checks on the report page, and its picture."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from builders import damper, oscillator, push, recording, spring

from symhyb.discrepancy.checks.first_checks import FirstChecks, first_checks
from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.numeric.lowered.machine import build
from symhyb.report import render_page
from symhyb.report.responding import response_figure

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]
M, K, D = 1.2, 300.0, 6.0


@pytest.fixture(scope="module")
def checks() -> FirstChecks:
    """An oscillator under three sines, with a model that knows no damping and one that does."""
    force = {"f": {"unit": "N"}}
    values = {"k": (K, "N/m"), "d": (D, "N*s/m")}
    known = {"hold": spring("k"), "motor": push("f")}
    model = oscillator(known, values, inputs=force)
    corrected = oscillator({**known, "found_damper": damper("d")}, values, inputs=force)
    t = np.arange(2000) / 100
    x, f = np.zeros(t.size), np.zeros(t.size)
    for line in (0.5, 1.5, 2.5):
        w = 2 * np.pi * line
        turn = np.exp(1j * w * t)
        x += 0.02 * turn.imag
        f += (0.02 * (K - M * w**2 + 1j * D * w) * turn).imag
    noise = 1e-5 * np.random.default_rng(2).standard_normal(t.size)
    run = recording(t, {"f": f}, place=x + noise)
    return first_checks(build(model), run, corrected=build(corrected))


@pytest.mark.parametrize("name", ["undecided", "failed"])
def test_the_page_says_each_check(checks: FirstChecks, cases: Cases, name: str) -> None:
    page = render_page("rig", *cases[name](), first=checks)
    assert "First checks" in page
    for check in ("sampling", "delays", "rest", "modes", "response", "energy"):
        assert f"<dt>{check}</dt>" in page
    assert "damping ratio 0" in page
    natural, ratio = np.sqrt(K / M) / (2 * np.pi), D / (2 * np.sqrt(K * M))
    assert f"{natural:.3f} Hz, damping ratio {ratio:.4f}" in page.replace("\u00a0", " ")
    assert "First checks" not in render_page("rig", *cases[name]())


def test_the_response_is_drawn_at_the_lines_of_the_drive(checks: FirstChecks) -> None:
    (response,) = checks.responses
    assert response.frequency == pytest.approx([0.5, 1.5, 2.5])
    assert response_figure(response).startswith(b"<?xml")
    two = replace(response, simulated={**response.simulated, "corrected": response.measured})
    assert response_figure(two) != response_figure(response)


def test_frequencies_over_decades_are_read_as_numbers(checks: FirstChecks) -> None:
    (response,) = checks.responses
    frequency = np.geomspace(0.4, 12.0, 20)
    gain = np.ones((20, 1), complex)
    wide = replace(
        response,
        frequency=frequency,
        measured=gain,
        simulated={"model": 2 * gain},
        coherence=np.ones(20),
    )
    drawn = response_figure(wide).decode()
    assert "mathdefault" not in drawn
    assert all(f"<!-- {number} -->" in drawn for number in ("0.5", "1", "2", "5", "10"))


def test_a_model_without_damping_misses_the_energy_and_the_response(checks: FirstChecks) -> None:
    assert checks.balance is not None
    w = 2 * np.pi * np.array([0.5, 1.5, 2.5])
    t = np.linspace(*checks.balance.span, 20_000)
    speed = 0.02 * np.cos(np.outer(t, w)) @ w
    lost = float(np.trapezoid(D * speed**2, t))
    assert checks.balance.unaccounted == pytest.approx(-lost, rel=5e-3)
    assert checks.responses[0].apart["model"] > 0.1
