"""Choose the settings of the peers on development seeds; writes results/peers.json.

    python studies/concealed/peer_tuning.py --seeds 0-999

For each peer the setting with the best F1 of causes (2·named / (concealed + claimed), null cases
included), and as ``… (quiet)`` the one that names most among those with a wrong claim on at most
1 % of the null cases. The network has no claims: its setting is the one with the best median fit.
The stepwise fit has one setting.
"""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from claims import Row
from peers import PEERS, STEPWISE, Setting, grid
from plans import ENGINE_SYSTEMS, SYSTEMS, folder_of, seeds_of
from results import HERE
from score import score_peer
from seal import unseal

QUIET = 0.01


def collect(options: argparse.Namespace) -> dict[Setting, list[Row]]:
    """Rows of every setting over the cases that all settings have answered."""
    rows: dict[Setting, list[Row]] = {one: [] for one in grid()}
    n = {system.name: system.n for system in (*SYSTEMS, *ENGINE_SYSTEMS)}
    for seed in seeds_of(options.seeds):
        folder = folder_of(seed, options.output)
        path = options.peers / f"{folder.name}.json"
        said = json.loads(path.read_text()) if path.exists() else {}
        if any(one.name not in said for one in rows):
            continue
        answer = unseal(folder / "sealed.json")
        for one, own in rows.items():
            reported = said[one.name]
            own.append(score_peer(folder.name, reported, answer, n[folder.name.split("-", 1)[1]]))
    return rows


def f1(rows: list[Row]) -> float:
    """2·named / (concealed + claimed)."""
    named, wanted = sum(row.name for row in rows), sum(row.wanted for row in rows)
    claimed = named + sum(len(row.wrong) for row in rows)
    return 2 * named / max(wanted + claimed, 1)


def said_of(setting: Setting, rows: list[Row]) -> dict[str, Any]:
    """A chosen setting and how it did on the development seeds."""
    nulls = [row for row in rows if not row.wanted]
    named, wanted = sum(row.name for row in rows), sum(row.wanted for row in rows)
    wrong = sum(bool(row.wrong) for row in nulls)
    network = setting.peer == "mlp"
    return {
        "setting": setting.name,
        "f1": None if network else round(f1(rows), 3),
        "named": "–" if network else f"{named} of {wanted}",
        "nulls": "–" if network else f"{wrong} of {len(nulls)}",
    }


def choose(rows: dict[Setting, list[Row]]) -> dict[str, dict[str, Any]]:
    """The settings to report."""
    chosen = {}
    for peer in PEERS:
        own = {one: cases for one, cases in rows.items() if one.peer == peer}
        if peer == "mlp":
            best = min(own, key=lambda one: float(np.median([r.fit for r in own[one]])))
            chosen[peer] = said_of(best, own[best])
            continue
        best = max(own, key=lambda one: f1(own[one]))
        chosen[peer] = said_of(best, own[best])
        quiet = [one for one in own if _alarms(own[one]) <= QUIET]
        if quiet:
            best = max(quiet, key=lambda one: (sum(r.name for r in own[one]), f1(own[one])))
            chosen[f"{peer} (quiet)"] = said_of(best, own[best])
    untuned = {"setting": STEPWISE.name, "f1": None, "named": "–", "nulls": "–"}
    return chosen | {"stepwise": untuned}


def _alarms(rows: list[Row]) -> float:
    nulls = [row for row in rows if not row.wanted]
    return sum(bool(row.wrong) for row in nulls) / max(len(nulls), 1)


def main() -> None:
    """Choose, and keep what was chosen."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-999")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/concealed"))
    parser.add_argument("--peers", type=Path, default=Path("build/concealed/peers"))
    parser.add_argument("--write", type=Path, default=HERE / "peers.json")
    options = parser.parse_args()
    rows = collect(options)
    cases = len(next(iter(rows.values())))
    if not cases:
        raise SystemExit("no case has the answers of all settings: run peers.py --every first")
    reported = {
        "seeds": options.seeds,
        "cases": cases,
        "tried": len(rows),
        "chosen": choose(rows),
    }
    options.write.parent.mkdir(parents=True, exist_ok=True)
    options.write.write_text(json.dumps(reported, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(reported, indent=1))


if __name__ == "__main__":
    main()
