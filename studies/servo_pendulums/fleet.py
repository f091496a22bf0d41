"""All falls as a fleet: inertia, damping and dry friction fitted to each, compared by mount.

python studies/servo_pendulums/fleet.py OUT        # a CSV a fall, fleet.csv, fleet.toml, study.toml
symhyb run OUT/study.toml -o out
symhyb fleet out --unit mount --over half          # half: 0 learned, 1 unseen
"""

import csv
import sys
from pathlib import Path

import pandas as pd
from falls import FOLDER, MODEL, Fall, folder_of_runs, read_falls, split

NUMBERS = """\
J = { value = 0.01, unit = "kg*m^2", about = "rotor behind the gear" }
c = { value = 0.05, unit = "N*m*s/rad", about = "viscous friction" }
F = { value = 0.05, unit = "N*m", about = "dry friction" }

[points]"""
ELEMENTS = """
[elements.rotor]
kind = "added_mass"
on   = "q"
mass = "J"

[elements.viscous]
kind    = "damper"
on      = "q"
damping = "c"

[elements.dry]
kind       = "friction"
on         = "q"
coulomb    = "F"
transition = "0.05 rad/s"
"""
STUDY = """\
symhyb = 1
title  = "Falls of a hobby servo"
model  = "fleet.toml"
fit    = ["J", "c", "F"]

[[train]]
table = "fleet.csv"

[sweep]
each = "recording"
"""


def write_fleet(halves: tuple[list[Fall], list[Fall]], out: Path) -> None:
    """Leave a folder with the falls of both halves, a table of them, a model and a study."""
    out.mkdir(parents=True, exist_ok=True)
    with open(out / "fleet.csv", "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        known = ["parameters.m", "parameters.l"]
        writer.writerow(
            ["file", *known, "groups.mount", "groups.half", "groups.gain", "groups.run"]
        )
        for half, falls in enumerate(halves):
            for one in falls:
                frame = pd.DataFrame({"t": one.t, "encoder": one.q})
                frame.to_csv(out / one.name, index=False)
                said = [one.mount, half, one.gain, one.run]
                writer.writerow([one.name, one.mass, one.length, *said])
    model = MODEL.read_text(encoding="utf-8").replace("\n[points]", NUMBERS, 1) + ELEMENTS
    (out / "fleet.toml").write_text(model, encoding="utf-8")
    (out / "study.toml").write_text(STUDY, encoding="utf-8")


def main() -> None:
    """Write the folder that is named."""
    folder, out = folder_of_runs(), Path(sys.argv[1])
    if folder is None:
        raise SystemExit(f"no {FOLDER} in the folder that SYMHYB_DATA names")
    write_fleet(split(read_falls(folder)), out)


if __name__ == "__main__":
    main()
