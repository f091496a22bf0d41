"""What was concealed against what was claimed: hits, twins, misses, wrong claims.

A concealed cause is a *hit* if it, or an exact twin of it, was named: place, kind, and (complete)
every number that gives the force its shape. What the noise of the recording cannot tell from it is
a hit too where it is named as an alternative. Every other claim is wrong. Several springs concealed
at one place are one element but several causes: there a claimed spring counts order by order.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

SHAPING = ("length", "transition")  # keys that no one has to find
HELD = 0.2  # part of half a sample by which the delay of a held input may be off
StandIns = dict[tuple[str, str], bool]  # where and kind: whether exactly the same


@dataclass(frozen=True, slots=True)
class Claim:
    """One cause, concealed or claimed: ``where`` is a place, ``parameter k`` or a channel."""

    where: str
    kind: str
    values: dict[str, tuple[float, float]] = field(default_factory=dict)  # term: value, sd
    side: str = ""

    @property
    def cause(self) -> tuple[str, str, str]:
        """What has to agree for a name."""
        return self.where, self.kind, self.side


@dataclass(frozen=True, slots=True)
class Row:
    """The score of one case: of ``wanted`` causes how many places and names were hit, by how many
    twins; ``structure``: all of them with all their numbers and nothing else; of ``counted`` values
    how many are within ± 2 sd; ``error``: unseen window error over that of the true model.
    ``shares`` of all causes (None: no force) and what became of each: ``hits`` 2 named, 1 placed,
    0 neither. ``cpu``: seconds of the process, None where they were not kept. ``rates`` were sensed
    too. ``fit``: unseen error of ΔF over that of the model as it is. ``may_refuse``: the draw was
    incomplete. ``hardship``: what makes the recordings harder."""

    case: str
    kind: str
    noise: float
    coordinates: int
    wanted: int
    share: float | None
    seconds: float
    verdict: str = ""
    place: int = 0
    name: int = 0
    structure: bool = False
    twins: int = 0
    wrong: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    covered: int = 0
    counted: int = 0
    error: float | None = None
    failed: str = ""
    cpu: float | None = None
    rates: bool = False
    shares: tuple[float | None, ...] = ()
    hits: tuple[int, ...] = ()
    fit: float | None = None
    may_refuse: bool = False
    hardship: str = ""

    @property
    def refused(self) -> bool:
        """Whether nothing was claimed at all."""
        return not self.wrong and self.name == 0


def concealed(answer: dict[str, Any]) -> list[Claim]:
    """The causes of a case in the order of the oracle's targets."""
    claims = [
        Claim(
            e["place"],
            e["kind"],
            {k: (v, 0.0) for k, v in e["keys"].items()},
            e["side"] if e["kind"] == "gap" else "",
        )
        for e in answer["effects"]
    ]
    claims += [
        Claim(f"parameter {name}", "parameter", {"value": (value, 0.0)})
        for name, value in answer["parameters"].items()
    ]
    claims += [
        Claim(f["channel"], f["kind"], {"value": (f["value"], 0.0)}) for f in answer["faults"]
    ]
    return claims


def claimed(reported: dict[str, Any]) -> list[Claim]:
    """What a diagnosis claims: forces, parameters, channels."""
    claims = []
    for found in reported["found"]:
        values = {p["term"]: (p["value"], p["sd"]) for p in found["parameters"].values()}
        side = found.get("options", {}).get("side", "both") if found["kind"] == "gap" else ""
        claims.append(Claim(_place(found["place"]), found["kind"], values, side))
    for one in reported["parameters"]:
        value = {"value": (one["value"], one["sd"])}
        claims.append(Claim(f"parameter {one['name']}", "parameter", value))
    for one in reported["measurement"]:
        claims.append(Claim(one["channel"], one["kind"], {"value": (one["value"], one["sd"])}))
    return claims


def alternatives(reported: dict[str, Any]) -> list[tuple[str, str]]:
    """Where and kind of what a diagnosis cannot rule out."""
    found = []
    for one in reported["alternatives"]:
        if "place" in one:
            found.append((_place(one["place"]), one["kind"]))
        elif "channel" in one:
            found.append((one["channel"], one["kind"]))
        else:
            found.append((f"parameter {one.get('parameter')}", "parameter"))
    return found


def _place(place: dict[str, Any]) -> str:
    (where,) = place.values()
    return where if isinstance(where, str) else "-".join(where)


def _rival(instead: dict[str, str]) -> tuple[str, str]:
    if "parameter" in instead:
        return f"parameter {instead['parameter']}", "parameter"
    return instead.get("place", instead.get("channel", "")), instead["kind"]


def _stand_ins(answer: dict[str, Any], truth: Sequence[Claim]) -> list[StandIns]:
    """For every concealed cause: what shows the same, and whether exactly (a partner) or within the
    noise."""
    first, rows = 0, []
    for claim in truth:
        rows.append(range(first, first + len(claim.values)))
        first += len(claim.values)
    return [
        {
            _rival(rival["instead"]): rival["apart"] < 1e-6
            for rival in answer["rivals"]
            if rival["of"] in mine
        }
        for mine in rows
    ]


def score_case(name: str, result: dict[str, Any], answer: dict[str, Any], n: int) -> Row:
    """Compare what was said with what was concealed."""
    truth = concealed(answer)
    reported = result.get("diagnosis")
    shares = [effect["share"] for effect in answer["effects"]]
    row = Row(
        name,
        answer["kind"],
        answer["noise"],
        n,
        len(truth),
        min(shares) if shares else None,
        result["seconds"],
        cpu=result.get("cpu_seconds"),
        fit=result.get("fit"),
        rates=answer.get("complete", False),
        may_refuse=answer.get("may_refuse", False),
        hardship=answer.get("hardship", {}).get("sort", ""),
        hits=(0,) * len(truth),
        shares=(*shares, *[None] * (len(truth) - len(shares))),
    )
    if reported is None:
        return replace(
            row,
            verdict="crash" if "crash" in result else "refused",
            structure=not truth,
            missed=tuple(map(_words, truth)),
            failed=result.get("sentence") or result.get("crash", ""),
        )
    rest, whole = _by_order(claimed(reported), truth), True
    rest = [c for c in rest if any(c.cause == t.cause for t in truth) or not _holds(c, answer)]
    pairs = list(zip(truth, _stand_ins(answer, truth), strict=True))
    placed = _placed(pairs, rest)
    hits = list(map(int, placed))
    row = replace(row, verdict=reported["verdict"], place=sum(placed))
    for i, (claim, stand_ins) in enumerate(pairs):
        same = next((c for c in rest if _same(c, claim, truth)), None)
        partner = next(
            (c for c in rest if _stands(c, claim, stand_ins, alternatives(reported))), None
        )
        if same is not None:
            rest.remove(same)
            hits[i] = 2
            row, whole = _valued(row, claim, same), whole and _complete(claim, same)
        elif partner is not None:
            rest.remove(partner)
            hits[i] = 2
            row = replace(row, name=row.name + 1, twins=row.twins + 1)
        else:
            row, whole = replace(row, missed=(*row.missed, _words(claim))), False
    wrong = [c for c in rest if not _spare(c, truth, hits)]
    return replace(
        row, structure=whole and not rest, wrong=tuple(map(_words, wrong)), hits=tuple(hits)
    )


def _holds(claim: Claim, answer: dict[str, Any]) -> bool:
    """Whether a claim says that an input is held: late by half a sample, which is what a staircase
    is to a machine that is slower than it. Nobody has to find that, and it is not wrong."""
    hardship = answer.get("hardship", {})
    if hardship.get("sort") != "held" or claim.where not in hardship["inputs"]:
        return False
    value, sd = claim.values.get("value", (0.0, 0.0))
    late = abs(value - hardship["delay"]) <= max(2 * sd, HELD * hardship["delay"])
    return claim.kind == "delay" and late


def _several(where: str, truth: Sequence[Claim]) -> bool:
    """Whether several springs are concealed at a place."""
    return sum(c.kind == "spring" and c.where == where for c in truth) > 1


def _by_order(said: Iterable[Claim], truth: Sequence[Claim]) -> list[Claim]:
    """The claims, with one claim for every order of a spring where several are concealed."""
    claims = []
    for claim in said:
        if claim.kind == "spring" and _several(claim.where, truth):
            orders = {k: v for k, v in claim.values.items() if k not in SHAPING}
            claims += [replace(claim, values={k: v}) for k, v in orders.items()] or [claim]
        else:
            claims.append(claim)
    return claims


def _same(claim: Claim, cause: Claim, truth: Sequence[Claim]) -> bool:
    """Whether a claim names a cause; the order counts where several springs are concealed."""
    if claim.cause != cause.cause:
        return False
    if cause.kind != "spring" or not _several(cause.where, truth):
        return True
    return not set(cause.values).isdisjoint(claim.values)


def _spare(claim: Claim, truth: Sequence[Claim], hits: Sequence[int]) -> bool:
    """Whether a claim is one more order of springs of which another was named: as for any element
    with a number too many, the structure is not complete, but no cause is claimed wrongly."""
    return (
        claim.kind == "spring"
        and _several(claim.where, truth)
        and any(hit == 2 and c.cause == claim.cause for hit, c in zip(hits, truth, strict=True))
    )


def _placed(pairs: Sequence[tuple[Claim, StandIns]], said: Sequence[Claim]) -> list[bool]:
    """Whether each concealed cause has a claim at its place, or one that stands for it."""
    return [
        any(c.where == claim.where or (c.where, c.kind) in stand_ins for c in said)
        for claim, stand_ins in pairs
    ]


def _valued(row: Row, truth: Claim, found: Claim) -> Row:
    """The row with one more named cause, and how many of its values the ± 2 sd cover."""
    keys = [key for key in truth.values if key in found.values]
    inside = sum(
        _off(key, truth.values[key][0], found.values[key][0]) <= 2 * found.values[key][1]
        for key in keys
    )
    counted = row.counted + len(keys)
    return replace(row, name=row.name + 1, counted=counted, covered=row.covered + inside)


def _off(key: str, truth: float, value: float) -> float:
    """The difference; an angle of phase counts modulo a turn."""
    if key == "phase":
        return abs(float(np.angle(np.exp(1j * (value - truth)))))
    return abs(value - truth)


def _stands(claim: Claim, truth: Claim, stand_ins: StandIns, spare: Iterable[Any]) -> bool:
    """Whether a claim may stand for the truth: an exact partner, or one within the noise that names
    the truth among its alternatives."""
    exact = stand_ins.get((claim.where, claim.kind))
    if exact is None:
        return False
    return exact or (truth.where, truth.kind) in spare


def _complete(truth: Claim, found: Claim) -> bool:
    wanted = {key for key in truth.values if key not in SHAPING}
    fitted = {key for key in found.values if key not in SHAPING}
    return wanted == fitted or (wanted < fitted and fitted - wanted <= {"transition", "stribeck"})


def _words(claim: Claim) -> str:
    keys = ",".join(sorted(k for k in claim.values if k not in SHAPING))
    values = ",".join(f"{v[0]:.4g}" for v in claim.values.values())
    return f"{claim.kind}{'.' + claim.side if claim.side else ''}({keys}={values}) @ {claim.where}"
