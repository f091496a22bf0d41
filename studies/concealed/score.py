"""Open the seals and score what was said; writes results.json and a table in Markdown.

python studies/concealed/score.py --seeds 0-99 -o build/concealed
"""

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from claims import Row, score_case
from draw import unseal
from hidden import Fault, Hidden
from laws import Effect
from plans import folder_of, plan_of, seeds_of
from truth import truth_text


def true_text(folder: Path, answer: dict[str, Any]) -> str:
    """The model file of a case with what was concealed written into it."""
    hidden = Hidden(
        tuple(Effect(e["kind"], e["place"], e["keys"], e["side"]) for e in answer["effects"]),
        answer["parameters"],
        tuple(Fault(f["channel"], f["kind"], f["value"]) for f in answer["faults"]),
    )
    return truth_text((folder / "model.toml").read_text(encoding="utf-8"), hidden)


def unseen_error(folder: Path, told: dict[str, Any], answer: dict[str, Any], keep: Path) -> float:
    """RMS over channels of the unseen window error over the same with the truth in the model."""
    if not keep.exists():
        import symhyb as sh
        from symhyb.model.read import parse_model

        model = sh.read_model(folder / "model.toml")
        holdout = sh.read_recording(folder / "holdout.csv", model)
        true = parse_model(true_text(folder, answer))
        verdict = sh.judge(model, true, holdout)
        scores = verdict.holdout.after.window_rmse if verdict.holdout else {}
        keep.parent.mkdir(parents=True, exist_ok=True)
        keep.write_text(json.dumps({"window_s": verdict.window_s, "rmse": dict(scores)}) + "\n")
    oracle = json.loads(keep.read_text())["rmse"]
    found = told["scores"]["holdout"]["after"]["window_rmse"]
    ratios = [
        found[k] / oracle[k] for k in oracle if oracle[k] and found.get(k) is not None
    ]  # fmt: skip
    return float(np.sqrt(np.mean(np.square(ratios)))) if ratios else float("nan")


def table(rows: Sequence[Row], title: str, key: Callable[[Row], Any]) -> str:
    """One Markdown table: a line for every value of ``key``."""
    lines = [
        f"| {title} | cases | place | name | complete | wrong claims | refused | ±2 sd | "
        "unseen error | time s |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for value in sorted({key(row) for row in rows}):
        lines.append(f"| {value} | " + _line([row for row in rows if key(row) == value]))
    lines.append("| all | " + _line(rows))
    return "\n".join(lines)


def _line(rows: Sequence[Row]) -> str:
    wanted = sum(row.wanted for row in rows)
    counted = sum(row.counted for row in rows)
    errors = [row.error for row in rows if row.error is not None and np.isfinite(row.error)]
    cells = [
        str(len(rows)),
        _percent(sum(row.place for row in rows), wanted),
        _percent(sum(row.name for row in rows), wanted),
        _percent(sum(row.structure for row in rows), len(rows)),
        _percent(sum(bool(row.wrong) for row in rows), len(rows)),
        _percent(sum(row.refused for row in rows), len(rows)),
        _percent(sum(row.covered for row in rows), counted),
        f"{np.median(errors):.3f}" if errors else "–",
        f"{np.median([row.seconds for row in rows]):.0f}",
    ]
    return " | ".join(cells) + " |"


def _percent(part: float, whole: float) -> str:
    return f"{100 * part / whole:.0f} %" if whole else "–"


def shares(row: Row) -> str:
    """The class of the smallest concealed force, as a share of the known ones."""
    if row.share is None:
        return "no force"
    edges = ((0.01, "a: below 1 %"), (0.03, "b: 1 to 3 %"), (0.1, "c: 3 to 10 %"))
    return next((words for edge, words in edges if row.share < edge), "d: above 10 %")


def read(options: argparse.Namespace) -> tuple[list[Row], int, int]:
    """All scored rows, how many draws were discarded, how many seeds were given up."""
    rows, discarded, given_up = [], 0, 0
    for seed in seeds_of(options.seeds):
        folder = folder_of(seed, options.output)
        result = options.results / f"{folder.name}.json"
        if (folder / "discarded.json").exists():
            given_up += 1
            discarded += json.loads((folder / "discarded.json").read_text())["discarded"]
        if not result.exists():
            continue
        told, answer = json.loads(result.read_text()), unseal(folder / "sealed.json")
        discarded += answer["discarded"]
        row = score_case(folder.name, told, answer, plan_of(seed).system.n)
        if options.errors and "diagnosis" in told and answer["effects"]:
            keep = options.output / "oracle" / f"{folder.name}.json"
            row = replace(row, error=unseen_error(folder, told["diagnosis"], answer, keep))
        rows.append(row)
    return rows, discarded, given_up


def report(rows: Sequence[Row], discarded: int, given_up: int) -> str:
    """The tables, the misses and the wrong claims, in Markdown."""
    nulls = [row for row in rows if row.wanted == 0]
    hidden = [row for row in rows if row.wanted]
    text = [f"{len(hidden)} cases with something concealed, {len(nulls)} with nothing; "
            f"{discarded} draws discarded, {given_up} seeds without a complete draw."]  # fmt: skip
    if hidden:
        text += ["", "## By kind", "", table(hidden, "kind", lambda row: row.kind)]
        text += ["", "## By noise", "", table(hidden, "noise", lambda row: f"{row.noise:.1%}")]
        text += ["", "## By share", "", table(hidden, "share", shares)]
        text += ["", "## By coordinates", "", table(hidden, "n", lambda row: row.coordinates)]
    if nulls:
        text += ["", "## Nothing concealed", "", table(nulls, "noise", lambda row: row.kind)]
        said = {v: sum(row.verdict == v for row in nulls) for v in {row.verdict for row in nulls}}
        text += ["", f"Verdicts: {said}"]
    text += ["", "## Misses and wrong claims", ""]
    for row in rows:
        if row.wrong or row.missed or row.failed or not row.structure:
            text.append(
                f"- {row.case} [{row.kind}, noise {row.noise:.1%}] {row.verdict}: "
                f"wrong {list(row.wrong)}, missed {list(row.missed)} {row.failed[:120]}"
            )
    return "\n".join(text) + "\n"


def main() -> None:
    """Score the cases of some seeds."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-999")
    parser.add_argument("--errors", action="store_true", help="unseen error over the oracle's")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/concealed"))
    parser.add_argument("--results", type=Path, default=Path("build/concealed/results"))
    options = parser.parse_args()
    rows, discarded, given_up = read(options)
    text = report(rows, discarded, given_up)
    (options.results / "report.md").write_text(text, encoding="utf-8")
    kept = json.dumps([asdict(row) for row in rows], indent=1) + "\n"
    (options.results / "results.json").write_text(kept, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
