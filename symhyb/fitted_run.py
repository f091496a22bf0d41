"""Model and recordings -> fitted parameters, judged on recordings that they were not fitted to."""

from collections.abc import Sequence
from dataclasses import dataclass

from symhyb.correction.calibration import Calibrated, calibrated, chosen
from symhyb.correction.search.so_far import if_interrupted
from symhyb.data.cleaning import cleaned
from symhyb.data.recording import Recording
from symhyb.discrepancy.checks.suspicion import repaired
from symhyb.discrepancy.fitting.judge import judge
from symhyb.discrepancy.results import Verdict
from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.memory import seldom_collected
from symhyb.steps import Say, silent
from symhyb.study.file import Study
from symhyb.study.run import read_all


@dataclass(frozen=True, slots=True, eq=False)
class FittedRun:
    """The ``model`` as given, what was fitted, and the errors before and after."""

    model: Model
    fitted: Calibrated
    verdict: Verdict


@seldom_collected()
def fit_study(study: Study, free: Sequence[str] = (), say: Say | None = None) -> FittedRun:
    """Fit parameters of the model of a study to its recordings, those ``free`` by name or all that
    state an sd, and judge them on its unseen recordings.

    Raises:
        InputError: the model, a recording or a name is wrong.
        NumericsError: the numerics failed.
    """
    tell = say or silent
    tell("reading the model and the recordings")
    model = read_model(study.model)
    chosen(model, free)  # a wrong name is said before recordings are read
    train, holdout = read_all(study, model)
    found = calibrated(model, train, free, say=tell)
    tell("judging the fitted model")
    with if_interrupted(found.sentence):
        return FittedRun(model, found, _judged(model, found, train, holdout))


def _judged(
    model: Model, found: Calibrated, train: Sequence[Recording], holdout: Sequence[Recording]
) -> Verdict:
    """Errors before and after, on recordings with their faults put right."""
    seen, unseen = (repaired(cleaned(group, model), found.faults) for group in (train, holdout))
    return judge(model, found.model, unseen, train=seen)
