"""A time after which work ends: how it is stated, and where it is asked for."""

import pytest

import symhyb as sh
from symhyb.deadline import (
    Deadline,
    OutOfTimeError,
    budget_text,
    deadline_of,
    require_time,
    seconds_of,
    within,
)


@pytest.mark.parametrize(
    ("stated", "seconds"),
    [("90s", 90.0), ("10min", 600.0), (" 1.5 h ", 5400.0), (".5 s", 0.5), (30, 30.0), (2.5, 2.5)],
)
def test_a_budget_is_a_number_of_seconds_or_a_text_with_its_unit(
    stated: float | str, seconds: float
) -> None:
    assert seconds_of(stated) == seconds


@pytest.mark.parametrize(
    "stated", ["", "10", "min", "0s", "-3s", "1e3s", "10 days", 0, -1.0, float("inf"), float("nan")]
)
def test_what_is_no_time_is_refused_in_a_sentence(stated: float | str) -> None:
    assert seconds_of(stated) is None
    with pytest.raises(sh.InputError) as refused:
        deadline_of(stated)
    (problem,) = refused.value.problems
    assert str(problem) == (
        f"budget: must be a time above 0 with its unit, s, min or h, as '10min', not {stated!r}"
    )


def test_a_time_is_said_in_its_largest_unit() -> None:
    said = [budget_text(seconds) for seconds in (0.25, 30.0, 90.0, 600.0, 5400.0)]
    assert said == ["0.25 s", "30 s", "1.5 min", "10 min", "1.5 h"]


def test_work_goes_on_until_the_deadline_and_not_beyond() -> None:
    now = [100.0]
    deadline = deadline_of("10s", lambda: now[0])
    assert deadline is not None
    require_time()  # nobody stated one
    with within(deadline):
        now[0] = 109.9
        require_time()
        now[0] = 110.0
        with pytest.raises(OutOfTimeError):
            require_time()
        with within(None):  # what a claim rests on takes the time that it takes
            require_time()
        with pytest.raises(OutOfTimeError):
            require_time()
    require_time()


def test_without_a_budget_there_is_no_deadline() -> None:
    assert deadline_of(None) is None
    assert not Deadline(1.0, 0.0, lambda: 0.5).passed
