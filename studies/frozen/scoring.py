"""What a case of the frozen set scores: concealed ones by the bench's rules, others by their terms.

A study's truth is ``found`` of its expected.json (and of sealed.json, where one lies beside it), an
example's is truth.json; both name place.term. A term is named if it was found, and its value counts
as right within two of its standard deviations or within the tolerance that the study states.
"""

import base64
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cases import EXAMPLES, ROOT, Case, missing

SHAPES = ("length", "transition", "stribeck")  # terms that shape a law and are no cause
SEALED_WITHIN = 0.05  # tolerance of a sealed value
Truth = Mapping[str, tuple[float | None, float]]  # place.term: value (None: not judged), part of it


@dataclass(frozen=True, slots=True)
class Outcome:
    """One case scored: of ``wanted`` causes or terms how many were named, whether all of them with
    nothing else, what was claimed wrongly, of ``counted`` values how many are right, CPU in s."""

    case: str
    group: str
    commit: str
    verdict: str
    wanted: int = 0
    named: int = 0
    complete: bool = False
    wrong: tuple[str, ...] = ()
    right: int = 0
    counted: int = 0
    cpu: float = 0.0

    @property
    def refused(self) -> bool:
        """Whether nothing was claimed at all."""
        return not self.wrong and self.named == 0

    @property
    def words(self) -> str:
        """The outcome in a line."""
        parts = [self.verdict, f"named {self.named} of {self.wanted}"]
        parts += ["complete"] * self.complete + ["refused"] * (self.refused and self.wanted > 0)
        parts += [f"wrong {', '.join(self.wrong)}"] if self.wrong else []
        parts += [f"values {self.right} of {self.counted}"] if self.counted else []
        return "; ".join(parts)

    @property
    def essence(self) -> tuple[Any, ...]:
        """What has to differ for a changed outcome: all but times and the numbers in words."""
        wrong = tuple(sorted(text.split("=")[0] for text in self.wrong))
        return (self.verdict, self.named, self.complete, wrong, self.right, self.counted)


def outcome(case: Case, reported: Mapping[str, Any], drawn: Path) -> Outcome:
    """The score of what was reported of a case."""
    if case.seed is not None:
        return _of_bench(case, reported, drawn / case.name)
    return _of_terms(case, reported, _study_truths(case) if case.study else [_example_truth(case)])


def _of_bench(case: Case, reported: Mapping[str, Any], folder: Path) -> Outcome:
    from claims import score_case
    from seal import unseal

    row = score_case(case.name, dict(reported), unseal(folder / "sealed.json"), 1)
    return Outcome(
        case.name,
        case.group,
        reported["commit"],
        row.verdict,
        row.wanted,
        row.name,
        row.structure,
        row.wrong,
        row.covered,
        row.counted,
        reported["cpu_seconds"],
    )


def _study_truths(case: Case) -> list[tuple[Truth, bool]]:
    """What a study may find, in each case of ``any_of``, and whether nothing else is right."""
    folder = ROOT / "studies" / case.study
    expected = json.loads((folder / "expected.json").read_text(encoding="utf-8"))
    always = dict(_stated(expected))
    strict = expected.get("nothing_else", False)
    seal = folder / "sealed.json"
    if seal.exists():
        text = json.loads(seal.read_text(encoding="ascii"))["found"]
        found = json.loads(base64.b64decode(text))
        always |= {name: (value, SEALED_WITHIN) for name, value in found.items()}
        strict = True
    several = expected.get("any_of") or [{}]
    return [
        ({**always, **dict(_stated(one))}, strict or one.get("nothing_else", False))
        for one in several
    ]


def _stated(expected: Mapping[str, Any]) -> Iterator[tuple[str, tuple[float, float]]]:
    for name, entry in expected.get("found", {}).items():
        yield name, (entry["value"], entry["within"])


def _example_truth(case: Case) -> tuple[Truth, bool]:
    """The truth of an example; a list or a text is a value that is not judged."""
    if reason := missing(case):
        raise SystemExit(f"{case.name}: {reason}")
    folder = Path(os.environ[EXAMPLES]) / case.example
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    stated = {name.replace("~", "-"): value for name, value in truth["found"].items()}
    stated |= {f"parameter.{name}": value for name, value in truth.get("parameters", {}).items()}
    judged = {
        name: (float(value) if isinstance(value, int | float) else None, 0.0)
        for name, value in stated.items()
    }
    return judged, True


def _of_terms(case: Case, reported: Mapping[str, Any], truths: list[tuple[Truth, bool]]) -> Outcome:
    """The score against the truth that fits best."""
    diagnosis = reported.get("diagnosis")
    if diagnosis is None:
        verdict = "crash" if "crash" in reported else "refused"
        wanted = min(len(truth) for truth, _ in truths)
        blank = (case.name, case.group, reported["commit"], verdict, wanted)
        return Outcome(*blank, cpu=reported["cpu_seconds"])
    claims = list(_claims(diagnosis))
    scored = [_against(case, reported, claims, truth, strict) for truth, strict in truths]
    best = max(scored, key=lambda one: (one.named, one.complete, -len(one.wrong), one.right))
    return replace(best, complete=best.complete and best.verdict == _verdict(case, best.verdict))


def _verdict(case: Case, otherwise: str) -> str:
    """The verdict that is right, ``otherwise`` where none is stated."""
    folder, name = ROOT / "studies" / case.study, "expected.json"
    if case.example:
        folder, name = Path(os.environ[EXAMPLES]) / case.example, "truth.json"
    stated = json.loads((folder / name).read_text(encoding="utf-8"))
    return str(stated.get("verdict", otherwise))


Claim = tuple[str, dict[str, tuple[float, float]]]  # what it is, its terms: value, sd


def _claims(diagnosis: Mapping[str, Any]) -> Iterator[Claim]:
    """Every claimed cause with its numbers by name, as studies name them."""
    for effect in diagnosis["found"]:
        (where,) = effect["place"].values()
        place = where if isinstance(where, str) else "-".join(where)
        terms = {
            f"{place}.{p['term']}": (p["value"], p["sd"]) for p in effect["parameters"].values()
        }
        yield f"{effect['kind']} @ {place}", terms
    for one in diagnosis["parameters"]:
        name = f"parameter.{one['name']}"
        yield name, {name: (one["value"], one["sd"])}
    for one in diagnosis["measurement"]:
        name = f"{one['channel']}.{one['kind']}"
        yield name, {name: (one["value"], one["sd"])}


def _against(
    case: Case, reported: Mapping[str, Any], claims: list[Claim], truth: Truth, strict: bool
) -> Outcome:
    """The score against one truth; an element is wrong where it has none of the wanted terms."""
    terms = {name: number for _, own in claims for name, number in own.items()}
    hits = {name: _hit(name, terms) for name in truth}
    named = {hit for hit in hits.values() if hit}
    wrong = tuple(text for text, own in claims if strict and not named & set(own))
    spare = [n for n in terms if n not in named and n.rpartition(".")[2] not in SHAPES]
    judged = [
        (value, within, *terms[hits[name]])
        for name, (value, within) in truth.items()
        if value is not None and hits[name]
    ]
    right = sum(abs(got - v) <= max(2 * sd, within * abs(v)) for v, within, got, sd in judged)
    return Outcome(
        case.name,
        case.group,
        reported["commit"],
        reported["diagnosis"]["verdict"],
        len(truth),
        sum(bool(hit) for hit in hits.values()),
        all(hits.values()) and not (strict and spare),
        wrong,
        right,
        len(judged),
        reported["cpu_seconds"],
    )


def _hit(name: str, terms: Mapping[str, Any]) -> str:
    """The found term that is meant, '' without; a place alone means whatever acts there."""
    place, _, term = name.partition(".")
    ends = place.split("-")
    for found in terms:
        where, _, what = found.partition(".")
        if term in ("", what) and where in (place, "-".join(reversed(ends))):
            return found
    return ""
