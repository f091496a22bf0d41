"""A mass on a spring is watched: what changes is named, what does not is left alone."""

from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from symhyb.errors import InputError
from symhyb.monitoring.changes import level, reference_of
from symhyb.monitoring.events import Event
from symhyb.monitoring.gauge import Gauge, amounts_of, block_of, change_phrase, gauge_of
from symhyb.monitoring.watching import Watch, watch
from tests.pushed import DAMPING, NOISE, STEP, STIFFNESS, pushed, pushed_model, pushing

REFERENCE_S = 30.0
SECONDS = 60.0
AT_S = 40.0


@cache
def rows(
    seed: int, stiffness: float = STIFFNESS, damping: float = DAMPING, gain: float = 1.0
) -> tuple[str, ...]:
    """What a logger writes: from ``AT_S`` on with other numbers."""
    random = np.random.default_rng(seed)
    t = STEP * np.arange(round(SECONDS / STEP))
    force, late = pushing(random, t), t >= AT_S
    x, state = np.empty(t.size), np.zeros(2)
    for part, (k, c, g) in ((~late, (STIFFNESS, DAMPING, 1.0)), (late, (stiffness, damping, gain))):
        system = StateSpace([[0.0, 1.0], [-k, -c]], [[0.0], [1.0]], np.eye(2), np.zeros((2, 1)))
        first = max(int(np.flatnonzero(part)[0]) - 1, 0)
        own = slice(first, int(np.flatnonzero(part)[-1]) + 1)
        _, states, _ = lsim(system, g * force[own], t[own] - t[first], X0=state)
        x[own], state = states[:, 0], states[-1]
    x += NOISE * random.standard_normal(t.size)
    return tuple(f"{a:.4f},{b:.6f},{c:.8f}" for a, b, c in zip(t, force, x, strict=True))


def watched(lines: Sequence[str | None], reference_s: float = REFERENCE_S) -> list[Event]:
    return list(watch(Watch(pushed_model(), reference_s), ["t,f,laser", *lines]))


def test_a_machine_that_does_not_change_is_left_alone() -> None:
    kinds = [event.kind for event in watched(rows(1))]
    assert kinds == ["ready", "ended"]


@pytest.mark.parametrize(
    ("changes", "cause", "size"),
    [
        ({"stiffness": 1.1 * STIFFNESS}, "stiffness", 0.1 * STIFFNESS),
        ({"damping": DAMPING + 1.0}, "damping", 1.0),
        ({"gain": 1.2}, "gain", 0.2),
    ],
)
def test_what_changes_is_named_within_seconds(
    changes: dict[str, float], cause: str, size: float
) -> None:
    found = watched(rows(2, **changes))
    (change,) = (event for event in found if event.kind == "changed")
    (said,) = (event for event in found if event.kind == "named")
    assert AT_S < change.at_s < AT_S + 10  # eight blocks
    assert change.since_s == pytest.approx(AT_S, abs=2.0)
    words = {"stiffness": "parameter k", "damping": "damp", "gain": "gain"}[cause]
    assert words in said.sentence or words in " ".join(said.rivals)
    assert any(abs(a.value - size) < max(5 * a.sd, 0.2 * size) for a in said.amounts)
    assert said.probability is not None


def test_after_a_change_the_machine_as_it_is_now_is_the_reference() -> None:
    lines = [*rows(2, stiffness=1.1 * STIFFNESS)]
    later = [
        f"{float(row.split(',', 1)[0]) + SECONDS - STEP:.4f},{row.split(',', 1)[1]}"
        for row in rows(3, stiffness=1.1 * STIFFNESS)[round(AT_S / STEP) + 1 :]
    ]
    times = [float(row.split(",", 1)[0]) for row in later]
    shift = times[0] - SECONDS
    later = [
        f"{time - shift:.4f},{row.split(',', 1)[1]}" for time, row in zip(times, later, strict=True)
    ]
    found = watched([*lines, *later])
    kinds = [event.kind for event in found if event.kind in ("ready", "changed", "named")]
    assert kinds[:4] == ["ready", "changed", "named", "ready"]


def test_rows_that_cannot_be_read_cost_a_block_and_no_more() -> None:
    lines: list[str | None] = [*rows(1)]
    lines[round(45 / STEP)] = "45.0,1"
    kinds = [event.kind for event in watched(lines)]
    assert kinds == ["ready", "unreadable", "ended"]


def test_time_that_goes_back_is_said() -> None:
    lines = [*rows(1), *rows(1)[round(30 / STEP) :]]
    assert "back" in [event.kind for event in watched(lines)]


def test_time_that_goes_back_after_a_change_loses_what_was_not_named_yet() -> None:
    changed = rows(2, stiffness=1.1 * STIFFNESS)
    seen = next(e.at_s for e in watched(changed) if e.kind == "changed")
    lines = [*changed[: round((seen + 1) / STEP)], *changed[round(30 / STEP) :]]
    kinds = [event.kind for event in watched(lines) if event.kind in ("changed", "back", "named")]
    assert kinds == ["changed", "back", "changed", "named"]


def test_a_source_that_is_silent_is_said_once() -> None:
    lines: list[str | None] = [*rows(1)[: round(35 / STEP)], *[None] * 200]
    assert [event.kind for event in watched(lines)] == ["ready", "silent", "ended"]


def test_a_reference_that_is_too_short_says_how_long_it_must_be() -> None:
    with pytest.raises(InputError, match="blocks; at least 20 are needed, which take"):
        watched(rows(1), reference_s=3.0)


def test_a_reference_with_a_wrong_unit_is_refused() -> None:
    lines = []
    for row in rows(1):
        t, f, x = row.split(",")
        lines.append(f"{t},{f},{1000 * float(x):.5f}")
    with pytest.raises(InputError, match="put that right before"):
        watched(lines)


@cache
def gauge() -> Gauge:
    return gauge_of(pushed_model(), pushed(1, samples=round(REFERENCE_S / STEP)))


def test_a_gauge_has_each_cause_once() -> None:
    hypotheses = gauge().hypotheses
    assert len(set(hypotheses)) == len(hypotheses) == len(gauge().causes.columns)
    assert not any(cause.bent or cause.variant for cause in hypotheses)


def test_a_block_of_noise_scatters_as_noise() -> None:
    made = [
        block_of(gauge(), pushed(seed, samples=round(gauge().block_s / STEP) + 1))
        for seed in range(30)
    ]
    reference = reference_of([block for block in made if block is not None])
    assert float(np.median(reference.scatter[reference.known])) < 3
    assert level(1.0, gauge().block_s, reference) < 1e-6


def test_a_change_is_said_in_the_units_of_the_file() -> None:
    for cause in range(len(gauge().hypotheses)):
        count = len(gauge().causes.columns[cause])
        amounts = amounts_of(gauge(), cause, np.ones(count), 0.1 * np.ones(count))
        assert len(amounts) == count
        assert all(amount.unit for amount in amounts)
        assert " by " in change_phrase(gauge(), cause, amounts)
