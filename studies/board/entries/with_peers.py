"""A peer of the bench of concealed effects, with the setting that was chosen on development seeds.

with_peers.py CASE ANSWER NAME      NAME of studies/concealed/results/peers.json, as 'weak (quiet)'

The equations are those of the generators, which are the model file's: a machine that is in neither
bench cannot be answered.
"""

import json
import sys
import tomllib
from typing import Any

from common import ROOT, folders, write

SAME = ("coordinates", "parameters", "inputs", "bodies", "elements")


def system_of(text: str) -> Any:
    """The machine of a bench that a model file describes.

    Raises:
        SystemExit: there is none.
    """
    from machines import MACHINES
    from plans import ENGINE_SYSTEMS, SYSTEMS

    wanted = tomllib.loads(text)
    for system in (*MACHINES.values(), *SYSTEMS, *ENGINE_SYSTEMS):
        known = tomllib.loads(system.text())
        if all(known.get(key) == wanted.get(key) for key in SAME):
            return system
    raise SystemExit("this model is that of no machine whose equations the peers have")


def corrected(text: str, said: dict[str, Any]) -> str:
    """The model file with what was claimed."""
    from hidden import Hidden
    from laws import Effect
    from truth import truth_text

    effects = []
    for one in said["found"]:
        ((_, names),) = one["place"].items()
        place = names if isinstance(names, str) else "-".join(names)
        keys = {key: number["value"] for key, number in one["parameters"].items()}
        side = one.get("options", {}).get("side", "both")
        effects.append(Effect(one["kind"], place, keys, side))
    return truth_text(
        text, Hidden(tuple(effects), {p["name"]: p["value"] for p in said["parameters"]})
    )


def main() -> None:
    """Answer."""
    name = sys.argv.pop()
    case, answer = folders()
    sys.path[:0] = [str(ROOT / "studies" / one) for one in ("concealed", "outside")]
    from peer_motion import recorded
    from peers import FIXED, claims, of_name

    text = (case / "model.toml").read_text(encoding="utf-8")
    chosen = json.loads(FIXED.read_text(encoding="utf-8"))["chosen"]
    said = claims(recorded(system_of(text), case / "train.csv"), of_name(chosen[name]["setting"]))
    if "diagnosis" not in said:
        raise SystemExit(said["sentence"])
    write(answer, **said["diagnosis"])
    (answer / "corrected.toml").write_text(corrected(text, said["diagnosis"]), encoding="utf-8")


if __name__ == "__main__":
    main()
