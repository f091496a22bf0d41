"""symhyb as an entry: a diagnosis and its corrected model.

with_symhyb.py CASE ANSWER [CHECKOUT]
"""

import json

from common import folders


def main() -> None:
    """Diagnose."""
    case, answer = folders()
    import symhyb as sh
    from symhyb.report.contract import to_json

    model = sh.read_model(case / "model.toml")
    train = sh.read_recording(case / "train.csv", model)
    diagnosis = sh.diagnose(model, train)
    claims = [diagnosis.found, diagnosis.parameters, diagnosis.measurement]
    if courses := getattr(diagnosis, "courses", ()):  # which older packages do not have
        claims.append(courses)
    corrected = sh.apply(model, *claims)
    said = to_json(diagnosis, sh.judge(model, corrected, train=train))
    (answer / "diagnosis.json").write_text(json.dumps(said), encoding="utf-8")
    sh.write_model(corrected, answer / "corrected.toml")


if __name__ == "__main__":
    main()
