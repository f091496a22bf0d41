"""What a diagnosis must not claim: corrections that foretell less than the model as given."""

import pytest

from symhyb.correction.verdict.proof import Proof
from symhyb.correction.verdict.refusal import if_confirmed
from symhyb.judgement import NOTABLE
from tests.fakes import NOTHING, friction

GOOD = Proof((), None, 0.5, 0.1)


def shown(before: float, after: float) -> Proof:
    return Proof((), None, before, after)


@pytest.mark.parametrize("after", [0.2, 1.0, (1 + NOTABLE)])
def test_a_correction_that_foretells_more_or_as_much_stands(after: float) -> None:
    diagnosis = friction()
    foretold = shown(1.0, after)
    assert if_confirmed(diagnosis, foretold, foretold) is diagnosis


@pytest.mark.parametrize(
    ("after", "said"), [(1.2, "rises from 50 % to 60 %"), (float("nan"), "is not finite")]
)
def test_a_correction_that_foretells_less_is_withdrawn(after: float, said: str) -> None:
    reported = if_confirmed(friction(), shown(0.5, after / 2), GOOD)
    assert reported.verdict == "undecided"
    assert not reported.found
    assert reported.alternatives[0].kind == friction().found[0].element.kind
    assert said in reported.sentence
    assert "held out of the fit" in reported.sentence


def test_what_is_unseen_is_said_and_withdraws_nothing() -> None:
    diagnosis = friction()
    reported = if_confirmed(diagnosis, GOOD, shown(0.02, 1.5))
    assert (reported.verdict, reported.found) == (diagnosis.verdict, diagnosis.found)
    assert "On unseen recordings the window NRMSE rises from 2 % to 150 %" in reported.sentence
    assert reported.notes[0] in reported.sentence


def test_nothing_is_refused_where_nothing_is_claimed_or_compared() -> None:
    assert if_confirmed(NOTHING, shown(0.5, 5.0), shown(0.5, 5.0)) is NOTHING
    diagnosis, unknown = friction(), shown(float("nan"), float("nan"))
    assert if_confirmed(diagnosis, unknown, unknown) is diagnosis
