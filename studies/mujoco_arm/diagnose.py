"""What a diagnosis says of the arm that MuJoCo simulates, beside what was concealed in it.

python studies/mujoco_arm/diagnose.py OUT [CASE…]    # a model and a corrected one of each case

A case takes one to three minutes of a processor; without names, all are diagnosed one by one.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

from recordings import CASES, Case, owners_model, record

import symhyb as sh


@dataclass(frozen=True, slots=True)
class Answer:
    """A ``diagnosis``, the model with all that it claims, and the scores of both."""

    diagnosis: sh.Diagnosis
    corrected: sh.Model
    verdict: sh.Verdict


def diagnosed(case: Case, folder: Path) -> Answer:
    """Import the owner's file, record the real arm, diagnose; models are left in ``folder``."""
    model = owners_model(case, folder / "model.toml")
    train, unseen = (
        sh.Recording.from_frame(record(case, part), model, name=part)
        for part in ("train", "unseen")
    )
    diagnosis = sh.diagnose(model, train, unseen)
    corrected = sh.apply(
        model, diagnosis.found, diagnosis.parameters, diagnosis.measurement, diagnosis.courses
    )
    sh.write_model(corrected, folder / "corrected.toml")
    return Answer(diagnosis, corrected, sh.judge(model, corrected, on=unseen))


def numbers(diagnosis: sh.Diagnosis) -> list[str]:
    """All that is claimed, a line a number, in the units of the model."""
    forces = [
        f"{found.element.name}.{one.term}: {one.value:.5g} ± {one.sd:.1g} {one.unit}"
        for found in diagnosis.found
        for one in found.estimates
    ]
    faults = [
        f"{one.channel}.{one.kind}: {one.value:.6g} ± {one.sd:.1g} {one.unit}"
        for one in diagnosis.measurement
    ]
    parameters = [
        f"{one.name}: {one.value:.5g} ± {one.sd:.1g} {one.unit}" for one in diagnosis.parameters
    ]
    return [*forces, *faults, *parameters]


def errors(verdict: sh.Verdict) -> list[str]:
    """The errors of angles on the unseen recording, before and after, a line a sensor."""
    scores = verdict.to_frame()
    return [
        f"unseen {row.score} of {row.of}: {row.before:.3g} -> {row.after:.3g} {row.unit}"
        for row in scores[scores.score.str.endswith("_rmse")].itertuples()
    ]


def tell(name: str, case: Case, folder: Path) -> None:
    """Diagnose a case, and print what was concealed beside what is claimed."""
    folder.mkdir(parents=True, exist_ok=True)
    answer = diagnosed(case, folder)
    print(f"{name}: {case.concealed}", f"  {answer.diagnosis.sentence}", sep="\n")
    for line in (*numbers(answer.diagnosis), *errors(answer.verdict)):
        print(f"  {line}", flush=True)


def main() -> None:
    """Diagnose the cases."""
    out, names = Path(sys.argv[1]), sys.argv[2:] or list(CASES)
    for name in names:
        tell(name, CASES[name], out / name)


if __name__ == "__main__":
    main()
