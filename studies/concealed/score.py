"""Open the seals and score what was said, by symhyb and by the peers.

    python studies/concealed/score.py --seeds 0-999 --errors [--keep development]
    python studies/concealed/score.py --seeds 0-99 --harder

Writes ``report.md`` and ``results.json`` beside the results; with ``--keep NAME`` also the small
file ``studies/concealed/results/NAME.json`` from which report.py makes the tables of the docs.
"""

import argparse
import json
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from claims import Row, score_case
from hidden import Fault, Hidden
from laws import Effect
from plans import Sort, add_sort, folder_of, plan_of, seeds_of
from report import section
from results import HERE, Scored, write
from seal import unseal
from truth import truth_text


def true_text(folder: Path, answer: dict[str, Any]) -> str:
    """The model file of a case with what was concealed written into it."""
    hidden = Hidden(
        tuple(Effect(e["kind"], e["place"], e["keys"], e["side"]) for e in answer["effects"]),
        answer["parameters"],
        tuple(Fault(f["channel"], f["kind"], f["value"]) for f in answer["faults"]),
    )
    return truth_text((folder / "model.toml").read_text(encoding="utf-8"), hidden)


def unseen_error(
    folder: Path, reported: dict[str, Any], answer: dict[str, Any], keep: Path
) -> float:
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
    found = reported["scores"]["holdout"]["after"]["window_rmse"]
    ratios = [found[k] / oracle[k] for k in oracle if oracle[k] and found.get(k) is not None]
    return float(np.sqrt(np.mean(np.square(ratios)))) if ratios else float("nan")


def force_ratio(reported: dict[str, Any]) -> float | None:
    """RMS over coordinates of the unseen force error with what was found over that without."""
    unseen = reported["scores"]["holdout"]
    pairs = [
        (unseen["after"]["force_nrmse"].get(k), size)
        for k, size in unseen["before"]["force_nrmse"].items()
    ]
    known = [(a, b) for a, b in pairs if a is not None and b]
    if not known:
        return None
    return float(np.sqrt(sum(a * a for a, _ in known) / sum(b * b for _, b in known)))


def cases(options: argparse.Namespace) -> Iterator[tuple[int, Path, dict[str, Any]]]:
    """Seed, folder and opened answer of every case that was drawn and has a result."""
    for seed in seeds_of(options.seeds):
        folder = folder_of(seed, options.output)
        result = options.results / f"{folder.name}.json"
        if result.exists() and (folder / "sealed.json").exists():
            yield seed, folder, unseal(folder / "sealed.json")


def read(options: argparse.Namespace) -> Scored:
    """All scored cases; a peer is reported of only where it has answered every one of them."""
    rows, said, commits, versions = [], [], set(), set()
    discarded, given_up = 0, 0
    for seed in seeds_of(options.seeds):
        discard = folder_of(seed, options.output) / "discarded.json"
        if discard.exists():
            given_up += 1
            discarded += json.loads(discard.read_text())["discarded"]
    for seed, folder, answer in cases(options):
        reported = json.loads((options.results / f"{folder.name}.json").read_text())
        commits.add(reported.get("commit", "unknown"))
        versions.add(reported.get("symhyb", "unknown"))
        discarded += answer["discarded"]
        row = score_case(folder.name, reported, answer, plan_of(seed).system.n)
        if "diagnosis" in reported:
            row = replace(row, fit=force_ratio(reported["diagnosis"]))
        if options.errors and "diagnosis" in reported and answer["effects"]:
            keep = options.output / "oracle" / f"{folder.name}.json"
            error = unseen_error(folder, reported["diagnosis"], answer, keep)
            row = replace(row, error=error if np.isfinite(error) else None)
        rows.append(row)
        path = options.peers / f"{folder.name}.json"
        others = json.loads(path.read_text()) if path.exists() else {}
        said.append((folder.name, others, answer, row.coordinates))
    about = {"symhyb": sorted(versions), "commits": sorted(commits)}
    peers, settings = peers_of(said)
    return Scored(
        options.seeds, tuple(rows), peers, discarded, given_up, {**about, "settings": settings}
    )


def peers_of(
    said: list[tuple[str, dict[str, Any], dict[str, Any], int]],
) -> tuple[dict[str, tuple[Row, ...]], dict[str, str]]:
    """Rows of every peer with the settings that were chosen, and those settings."""
    fixed = HERE / "peers.json"
    chosen = json.loads(fixed.read_text())["chosen"] if fixed.exists() else {}
    rows, settings = {}, {}
    for name, row in chosen.items():
        setting = row["setting"]
        if said and all(setting in others for _, others, _, _ in said):
            rows[name] = tuple(
                score_peer(case, others[setting], answer, n) for case, others, answer, n in said
            )
            settings[name] = setting
    return rows, settings


def score_peer(case: str, reported: dict[str, Any], answer: dict[str, Any], n: int) -> Row:
    """The row of a peer, by the rules for everybody; one without words (a network) claims
    nothing."""
    silent = {"verdict": "", "found": [], "parameters": [], "measurement": [], "alternatives": []}
    whole = {"diagnosis": silent, "fit": 1.0 if "crash" in reported else None, **reported}
    whole |= {"cpu_seconds": reported["seconds"]}
    return score_case(case, whole, answer, n)


def main() -> None:
    """Score the cases of some seeds."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", default="0-999")
    parser.add_argument("--errors", action="store_true", help="unseen error over the oracle's")
    parser.add_argument("--keep", default="", help="name of the file for the docs")
    add_sort(parser)
    parser.add_argument("--results", type=Path, help="default: results in the folder of the cases")
    parser.add_argument("--peers", type=Path, help="default: peers in the folder of the cases")
    options = parser.parse_args()
    options.output = options.output or Sort(options.harder, options.keep_hard).build
    options.results = options.results or options.output / "results"
    options.peers = options.peers or options.output / "peers"
    scored = read(options)
    text = section(scored) + "\n" + misses(scored.rows)
    (options.results / "report.md").write_text(text, encoding="utf-8")
    kept = json.dumps([asdict(row) for row in scored.rows], indent=1) + "\n"
    (options.results / "results.json").write_text(kept, encoding="utf-8")
    if options.keep:
        write(HERE / f"{options.keep}.json", scored)
    print(text)


def misses(rows: tuple[Row, ...]) -> str:
    """Every case that was not reported completely, a line each."""
    text = ["Misses and wrong claims", ""]
    for row in rows:
        if row.wrong or row.missed or row.failed or not row.structure:
            text.append(
                f"- {row.case} [{row.kind}, noise {row.noise:.1%}"
                f"{', ' + row.hardship if row.hardship else ''}"
                f"{', may be refused' if row.may_refuse else ''}] {row.verdict}: "
                f"wrong {list(row.wrong)}, missed {list(row.missed)} {row.failed[:120]}"
            )
    return "\n".join(text) + "\n"


if __name__ == "__main__":
    main()
