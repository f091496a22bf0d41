"""What the model of an arm's URDF lacks, beside least squares that know what is missing.

python studies/arm/diagnose.py OUT    # arm.toml and corrected.toml

It takes five minutes of a processor.
"""

import sys
from pathlib import Path

from by_hand import error, solved, torques_of
from recordings import arm, required_folder, split

import symhyb as sh


def main() -> None:
    """Diagnose, and print what is left of the torques of the unseen part."""
    folder, out = required_folder(), Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    model = arm(folder, out / "arm.toml")
    train, unseen = split(folder, model)
    diagnosis = sh.diagnose(model, train, unseen, say=lambda line: print(line, flush=True))
    print(diagnosis.sentence)
    for note in diagnosis.notes:
        print(f"  {note}")
    corrected = sh.apply(model, diagnosis.found)
    sh.write_model(corrected, out / "corrected.toml")
    learned, rest, left = (
        torques_of(one, part)
        for one, part in ((model, train), (model, unseen), (corrected, unseen))
    )
    by_hand = rest.lacks - rest.columns @ solved(learned)
    print("what is left of the torques of the unseen part, below 75 Hz:")
    print(f"  as the URDF says    {error(rest.lacks, rest.applied):.3f}")
    print(f"  as diagnosed        {error(left.lacks, left.applied):.3f}")
    print(f"  by least squares    {error(by_hand, rest.applied):.3f}")


if __name__ == "__main__":
    main()
