"""Why CVODES stopped, in a sentence for each of its return codes, and none of its own text."""

import numpy as np
import pytest

from symhyb.numeric.runs import cvodes
from symhyb.numeric.runs.cvodes import jumps_of

GRID = np.array([1.0, 2.5])
CODES = (
    "CV_TOO_MUCH_WORK",
    "CV_TOO_MUCH_ACC",
    "CV_ERR_FAILURE",
    "CV_CONV_FAILURE",
    "CV_LINIT_FAIL",
    "CV_LSETUP_FAIL",
    "CV_LSOLVE_FAIL",
    "CV_RHSFUNC_FAIL",
    "CV_FIRST_RHSFUNC_ERR",
    "CV_REPTD_RHSFUNC_ERR",
    "CV_UNREC_RHSFUNC_ERR",
    "CV_MEM_FAIL",
    "CV_ILL_INPUT",
    "CV_BAD_T",
    "CV_TOO_CLOSE",
    "CV_A_NEW_ONE",
)


@pytest.mark.parametrize("code", CODES)
def test_every_return_code_is_a_sentence_with_its_time(code: str) -> None:
    error = RuntimeError(f'run:sundials_interface.cpp:12: CVode returned "{code}". Consult CVODES.')
    said = cvodes._explain(error, np.ones(2), GRID, 500.0)
    assert said.startswith("CVODES ")
    assert "between 1 and 2.5 s" in said
    assert "sundials" not in said
    assert code not in said
    assert ("says not why" in said) == (code == "CV_A_NEW_ONE")


def test_a_state_that_is_far_too_large_has_grown() -> None:
    said = cvodes._explain(RuntimeError("CV_ILL_INPUT"), np.array([1e9]), GRID, 500.0)
    assert said == "the motion grew without bound between 1 and 2.5 s"


def test_jumps_of_an_input_are_where_it_begins_and_ends_to_jump() -> None:
    t = np.linspace(0, 1, 11)
    drive = np.where(t < 0.45, 0.0, 1.0)[:, None]
    assert jumps_of(t, drive, t) == pytest.approx([0.4, 0.5])
    assert jumps_of(t, np.empty((11, 0)), t).size == 0
    assert jumps_of(t, np.sin(t)[:, None], t).size == 0
