"""The bench outside the vocabulary, as the board sees it."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from benches import Drawn
from draw import kinds_of, write
from lines import Line
from outcomes import ACTUATORS, COUPLINGS, SHAPES, Row, score_case
from shared import Claim, claimed

BUILD = Path("build/outside")
SEEDS = 1000, 9999  # from which fresh ones are drawn
WORDS = {"class right": "right"}
WITHIN = 2.0  # sd


def drawn(seeds: Sequence[int], kinds: str, build: Path) -> Iterator[Drawn]:
    """The cases of seeds and kinds, drawn where they are not there."""
    for seed in seeds:
        for kind in kinds_of(kinds):
            folder = write(kind, seed, build)
            if folder is not None:
                yield Drawn(folder.name, folder)


def line(case: Drawn, result: dict[str, Any], sealed: dict[str, Any]) -> Line:
    """The score of one answer."""
    row = score_case(case.name, result, sealed)
    said = result.get("diagnosis")
    acts = "noise" not in sealed["classes"]
    right = row.outcome == "class right"
    claims = claimed(said) if said else []
    held = [inside for claim in claims for inside in _numbers(claim, sealed)]
    return Line(
        case.name,
        row.kind,
        WORDS.get(row.outcome, row.outcome),
        int(acts),
        int(acts and (row.placed or any(claim.where == sealed["place"] for claim in claims))),
        int(acts and right),
        right,
        row.wrong,
        sum(held),
        len(held),
        _stated(said, row, sealed) if said else (),
        reason=row.sentence if row.outcome == "failed" else "",
    )


def _numbers(claim: Claim, sealed: dict[str, Any]) -> Iterator[bool]:
    """Whether numbers of a claim whose truth the seal holds are within 2 sd of it."""
    true = _truth(claim, sealed)
    for key, (value, sd) in claim.values.items():
        if key in true:
            yield abs(value - true[key]) <= WITHIN * sd


def _truth(claim: Claim, sealed: dict[str, Any]) -> dict[str, float]:
    facts = sealed.get("facts", {})
    if claim.where != sealed["place"]:
        return {}
    if sealed["law"] and claim.kind == sealed["law"][0]:
        return {sealed["law"][2]: sealed["law"][3]}
    if claim.kind not in sealed["accepted"]:
        return {}
    if claim.kind in ACTUATORS and ACTUATORS[claim.kind] in facts:
        return {"value": facts[ACTUATORS[claim.kind]]}
    if claim.kind in COUPLINGS and "across" in facts:
        key, sign = COUPLINGS[claim.kind]
        return {key: sign * facts["across"]}
    return {key: facts[key] for key in SHAPES if key in facts}


def _stated(
    said: dict[str, Any], row: Row, sealed: dict[str, Any]
) -> tuple[tuple[float, bool], ...]:
    """Stated probabilities of the most probable class, and of claimed elements where something is
    claimed, with whether each is right."""
    pairs = []
    if row.stated:
        best = max(one["probability"] for one in said["classes"])
        pairs.append((best, row.stated in sealed["classes"]))
    for one in said["found"]:
        if "probability" in one:
            (names,) = one["place"].values()
            where = names if isinstance(names, str) else "-".join(names)
            wrong = any(words.startswith(f"{one['kind']} at {where} (") for words in row.wrong)
            pairs.append((one["probability"], not wrong))
    return tuple(pairs)
