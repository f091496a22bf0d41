"""What is learned from the same cases without an answer in words: PySINDy and networks on ΔF.

    python studies/outside/peers.py --seeds 0-13 --kinds formula [--workers 1]

Each way sees model and training recording, as a diagnosis does, and its corrected model runs freely
along the unseen recording. One JSON a case and way; what is there is not learned again. The table
counts how many miss it by at most 2 % of its range, beside what a diagnosis claims, where
``run.py`` has been run.
"""

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from draw import folder_of, kinds_of, write
from joblib import Parallel, delayed
from kinds import Kind
from outcomes import missed
from score import EQUAL
from shared import HERE, seeds_of

BUILD = HERE.parents[1] / "build" / "outside"
WAYS: dict[str, dict[str, Any]] = {
    "PySINDy, laws": {"by": "sparse", "library": "laws"},
    "PySINDy, polynomials": {"by": "sparse", "library": "polynomial"},
    "networks": {"by": "network"},
}
CLAIMED = "symhyb, where it claims"


def learned(folder: Path, way: str) -> dict[str, Any]:
    """The largest error of a sensor in a free run along the unseen recording, over its range,
    ``before`` and ``after``; None where a run ended early; or why nothing was learned."""
    import symhyb as sh

    begin = time.process_time()
    try:
        model = sh.read_model(folder / "model.toml")
        train, unseen = (
            sh.read_recording(folder / f"{name}.csv", model) for name in ("train", "holdout")
        )
        verdict = sh.learn(model, train, unseen, **WAYS[way]).verdict
        assert verdict.holdout is not None
        both = verdict.holdout.before, verdict.holdout.after
        before, after = (_worst(score.free_run_nrmse.values()) for score in both)
    except (sh.InputError, sh.NumericsError) as error:
        return {"error": str(error), "cpu_seconds": time.process_time() - begin}
    return {"before": before, "after": after, "cpu_seconds": time.process_time() - begin}


def _worst(values: Any) -> float | None:
    known = [value for value in values if value is not None]
    return max(known) if known else None


def one(kind: Kind, seed: int, build: Path, results: Path) -> None:
    """Learn from one case in every way that is not there yet."""
    folder = write(kind, seed, build)
    if folder is None:
        return
    for way in WAYS:
        target = results / f"{folder.name} {way}.json"
        if not target.exists():
            found = learned(folder, way)
            part = target.with_suffix(".part")
            part.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
            part.replace(target)
            print(f"{folder.name}, {way}: {found.get('after', found.get('error'))}", flush=True)


def rows_of(cases: list[str], results: Path, answers: Path) -> dict[str, list[dict[str, Any]]]:
    """What each way, and a diagnosis, reached in the cases that both have, by way."""
    found: dict[str, list[dict[str, Any]]] = {way: [] for way in (*WAYS, CLAIMED)}
    for case in cases:
        files = {way: results / f"{case} {way}.json" for way in WAYS}
        if not all(file.exists() for file in files.values()):
            continue
        for way, file in files.items():
            found[way].append(json.loads(file.read_text(encoding="utf-8")))
        answer = answers / f"{case}.json"
        if answer.exists():
            said = json.loads(answer.read_text(encoding="utf-8")).get("diagnosis", {})
            errors = missed(said)
            claims = said.get("verdict") != "undecided" and errors is not None
            known = dict(zip(("before", "after"), errors or (), strict=False))
            found[CLAIMED].append(known if claims else {})
    return found


def table(found: dict[str, list[dict[str, Any]]]) -> str:
    """Counts and medians by way, as Markdown."""
    lines = [
        f"| way | cases | unseen free run within {EQUAL:.0%} | median | worse than the model |",
        "|---|---|---|---|---|",
    ]
    for way, rows in found.items():
        after = [row["after"] for row in rows if row.get("after") is not None]
        pairs = [
            (row["before"], row["after"])
            for row in rows
            if None not in (row.get("before"), row.get("after"))
        ]
        within = sum(value <= EQUAL for value in after)
        middle = f"{float(np.median(after)):.2%}" if after else "–"
        worse = sum(now > was for was, now in pairs) + sum(
            row.get("after") is None and "before" in row for row in rows
        )
        lines.append(f"| {way} | {len(rows)} | {within} | {middle} | {worse} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Learn from the cases of some seeds and kinds, and print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-13")
    parser.add_argument("--kinds", default="formula", help="names, separated by commas")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path, default=BUILD, help="where cases are drawn")
    parser.add_argument("--results", type=Path, default=BUILD / "peers")
    parser.add_argument("--answers", type=Path, default=BUILD / "results", help="those of run.py")
    options = parser.parse_args()
    options.results.mkdir(parents=True, exist_ok=True)
    cases = [(kind, seed) for seed in seeds_of(options.seeds) for kind in kinds_of(options.kinds)]
    Parallel(n_jobs=options.workers)(
        delayed(one)(kind, seed, options.output, options.results) for kind, seed in cases
    )
    names = [folder_of(kind, seed, options.output).name for kind, seed in cases]
    print(table(rows_of(names, options.results, options.answers)))


if __name__ == "__main__":
    main()
