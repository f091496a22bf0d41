"""PySINDy and networks on ΔF by ``symhyb learn``: laws, polynomials, or a network without words.

with_learning.py CASE ANSWER laws|polynomial|network

PySINDy's optimisers propose terms, windows that are not fitted choose (docs/learn.md). A term that
is a law of the model file is claimed as that; any other is a force ``law`` without a name.
"""

import sys

from common import element, folders, write

NAMED = {
    "damper": ("damping",),
    "drag": ("drag",),
    "friction": ("coulomb",),
    "constant": ("constant",),
    "spring": ("stiffness", "quadratic", "cubic"),
}


def main() -> None:
    """Learn."""
    way = sys.argv.pop()
    case, answer = folders()
    import symhyb as sh

    model = sh.read_model(case / "model.toml")
    train = sh.read_recording(case / "train.csv", model)
    how = {"by": "network"} if way == "network" else {"by": "sparse", "library": way}
    learned = sh.learn(model, train, **how)
    corrected = learned.corrected
    if corrected is not None:
        sh.write_model(corrected, answer / "corrected.toml")
    new = [] if corrected is None else corrected.elements[len(model.elements) :]
    found = [
        element(
            one.kind,
            {"on": one.place.coordinate},
            {p.name: (p.value, p.sd or 0.0) for p in one.parameters},
        )
        for one in new
        if one.kind != "network"
    ]
    verdict = "missing physics" if found else "nothing missing"
    if way == "network" and learned.something:
        verdict = "undecided"
    write(answer, verdict=verdict, sentence=learned.sentence, found=found)


if __name__ == "__main__":
    main()
