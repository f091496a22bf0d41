"""How many odd drives were found, and with the right reason.

symhyb fleet out --unit drive --over temperature,hours --json > fleet.json
python studies/fleet/score.py FOLDER/truth.json fleet.json

A reason is right if the number that was changed is the one that deviates most in its deviations, or
if the structure is said not to hold where it does not; exact, if no other number is named with it.
"""

import json
import sys
from pathlib import Path
from typing import Any


def score(truth: dict[str, list[str]], facts: dict[str, Any]) -> dict[str, Any]:
    """Counts of what was found, right, exact and false, and the lines that say so."""
    reasons = {one["name"]: one["reason"] for one in facts["units"] if one["reason"]}
    lines, right, exact = [], 0, 0
    for name, (kind, wanted) in truth.items():
        reason = reasons.get(name)
        named = [] if reason is None else named_by(reason)
        right += named[:1] == [wanted]
        exact += named == [wanted]
        lines.append(f"{name}  {kind}: {', '.join(named) or 'missed'}")
    false = sorted(set(reasons) - set(truth))
    lines += [f"{name}  false: {reasons[name]['sentence']}" for name in false]
    found = sum(name in reasons for name in truth)
    return {"found": found, "right": right, "exact": exact, "false": len(false), "lines": lines}


def named_by(reason: dict[str, Any]) -> list[str]:
    """What a reason names, the most significant first."""
    if reason["kind"] == "structure":
        return ["structure"]
    ordered = sorted(reason["off"], key=lambda one: -abs(one["by"]) / one["sd"])
    return [one["name"] for one in ordered]


def main() -> None:
    """Print the score of one fleet."""
    truth, facts = (json.loads(Path(file).read_text(encoding="utf-8")) for file in sys.argv[1:3])
    counts = score(truth, facts)
    print(*counts.pop("lines"), sep="\n")
    print(f"of {len(truth)}: {counts}; units: {len(facts['units'])}")


if __name__ == "__main__":
    main()
