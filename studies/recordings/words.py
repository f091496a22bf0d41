"""Rows and phrases of the page: what a model knows, numbers beside published ones, errors."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from kept import Case

from symhyb.data.catalogue import named as dataset_named
from symhyb.discrepancy.words.amounts import joined, number_text, quantity_text
from symhyb.model.read import read_model
from symhyb.model.types import Model, place_text
from symhyb.study.expected import found_terms, score_at
from symhyb.study.published import Reference
from symhyb.study.sources import Source
from symhyb.units import parse_unit

SCORES = {"window": "windows of {window}", "free_run": "free run"}
MINUS = "\N{MINUS SIGN}"
Number = tuple[str, str, str, str]


@dataclass(frozen=True, slots=True)
class ScoreRow:
    """One error on the unseen recordings before and after, and what is published of it."""

    kind: str
    words: str
    sensor: str
    unit: str
    before: float | None
    after: float | None
    published: str


@cache
def model_of(file: Path) -> Model:
    """The model of a study."""
    return read_model(file)


def about(case: Case) -> str:
    """Which machine it is and who recorded it."""
    sources = [*case.study.train, *case.study.holdout]
    names = dict.fromkeys(source.data.split("/")[0] for source in sources if source.data)
    known = [dataset for name in names if (dataset := dataset_named(name)) is not None]
    return " ".join(f"{one.title} (`{one.name}`). {one.citation}." for one in known)


def knows(case: Case) -> str:
    """What the model file declares: elements and the values of parameters."""
    model = model_of(case.study.model)
    parts = [f"{one.kind} {place_text(one.place)}" for one in model.elements]
    values = []
    for one in model.parameters:
        amount = quantity_text(one.value, one.unit.text, one.sd, digits=6)
        held = " (held)" if one.sd is None else ""
        values.append(f"{one.name} = {amount}{held}{f', {one.about}' if one.about else ''}")
    elements = f"elements: {joined(parts)}" if parts else "no element"
    numbers_ = f"; {'; '.join(values)}" if values else "; no number"
    return f"{model.title}. In the file: {elements}{numbers_}."


def reported(case: Case) -> Iterator[tuple[str, str]]:
    """Which recordings it learned from and was proved on."""
    for role, sources in (
        ("Learned from", case.study.train),
        ("Proved on", case.study.holdout),
    ):
        if sources:
            yield role, joined(list(dict.fromkeys(map(_source, sources))))


def _source(source: Source) -> str:
    name = source.data.partition("/")[2] if source.data else source.file.name if source.file else ""
    name = f"`{name or source.data}`"
    start, end = source.span
    if start is None and end is None:
        return name
    return f"{name} ({'' if start is None else f'{start:g}'}–{'' if end is None else f'{end:g}'} s)"


def rivals(kept: Mapping[str, Any]) -> str:
    """What the data cannot rule out, in a clause; the first five."""
    names = []
    for rival in kept["alternatives"]:
        where = rival.get("channel") or rival.get("parameter") or _place(rival.get("place"))
        names.append(f"{rival['kind']} {'of' if 'place' not in rival else 'on'} {where}")
    listed = list(dict.fromkeys(names))
    return ", ".join(listed[:5]) + (f" and {len(listed) - 5} more" if len(listed) > 5 else "")


def _place(place: Mapping[str, Any] | None) -> str:
    (where,) = (place or {"on": "?"}).values()
    return where if isinstance(where, str) else "–".join(where)


def numbers(case: Case) -> Iterator[Number]:
    """Rows of name, found, published, difference: what was found, then what else is published."""
    assert case.kept is not None
    found = found_terms(case.kept)
    published = dict(case.expected.published.found) if case.expected.published else {}
    for name, ours in found.items():
        theirs = published.pop(name, None)
        ours = _converted(ours, theirs.unit) if theirs else ours
        amount = quantity_text(ours["value"], ours["unit"], ours["sd"])
        off = difference(ours, theirs) if theirs else ""
        yield named(name, theirs), amount, _published(theirs), off
    for name, theirs in published.items():
        yield named(name, theirs), "", _published(theirs), "not found"


def named(name: str, theirs: Reference | None) -> str:
    """``x.coulomb``, with what the literature calls it."""
    return f"`{name}`" + (f" ({theirs.about})" if theirs and theirs.about else "")


def _converted(ours: Mapping[str, Any], unit: str) -> dict[str, Any]:
    """A number in the unit of the published one.

    Raises:
        ValueError: the two do not measure the same thing.
    """
    mine, theirs = parse_unit(ours["unit"]), parse_unit(unit)
    if not mine.same_dimension(theirs):
        raise ValueError(f"published in {unit}, but found in {ours['unit']}")
    factor = mine.factor / theirs.factor
    return {**ours, "value": ours["value"] * factor, "sd": ours["sd"] * factor, "unit": unit}


def _published(theirs: Reference | None) -> str:
    return quantity_text(theirs.value, theirs.unit, theirs.sd, digits=6) if theirs else ""


def difference(ours: Mapping[str, Any], theirs: Reference) -> str:
    """How far a number is off the published one, in percent and in standard deviations; both in one
    unit."""
    off = ours["value"] - theirs.value
    spread = (ours["sd"] ** 2 + (theirs.sd or 0.0) ** 2) ** 0.5
    part = f"{100 * off / theirs.value:+.1f} %".replace("-", MINUS) if theirs.value else ""
    return ", ".join(x for x in (part, f"{abs(off) / spread:.1f} sd" if spread else "") if x)


def score_rows(case: Case) -> Sequence[ScoreRow]:
    """Errors on the unseen recordings, by sensor, and force residuals of which one is published."""
    assert case.kept is not None
    scores = case.kept["scores"]
    if scores["holdout"] is None:
        return ()
    theirs = case.expected.published.scores if case.expected.published else {}
    units = {sensor.name: str(sensor.unit) for sensor in model_of(case.study.model).sensors}
    window = f"{number_text(scores['window_s'], digits=3)} s"
    rows = []
    for kind, words in SCORES.items():
        for sensor, before in scores["holdout"]["before"][f"{kind}_rmse"].items():
            said = f"{sensor}, {words.format(window=window)}"
            path = f"{kind}_rmse.{sensor}"
            after = score_at(scores, f"holdout.after.{path}")
            rows.append(
                ScoreRow(kind, said, sensor, units[sensor], before, after, _score(theirs, path))
            )
    band = scores.get("force_band_hz")
    for coordinate, before in scores["holdout"]["before"].get("force_residual", {}).items():
        path = f"force_residual.{coordinate}"
        after = score_at(scores, f"holdout.after.{path}")
        said = f"{coordinate}, ‖ΔF‖ / ‖applied force‖ below {number_text(band, digits=3)} Hz"
        if f"holdout.after.{path}" in theirs:
            rows.append(
                ScoreRow("force", said, coordinate, "1", before, after, _score(theirs, path))
            )
    return rows


def own_scores(case: Case) -> str:
    """The table of a study's own ``scores.json``: about, by, unit, and rows of numbers by column;
    empty without one. What is published of a row is found by its name."""
    figures = case.figures
    if figures is None:
        return ""
    theirs = case.expected.published.scores if case.expected.published else {}
    columns = list(dict.fromkeys(name for row in figures["rows"].values() for name in row))
    head = " | ".join([figures["about"], *columns, "published"])
    lines = [f"| {head} |", "|---" * (len(columns) + 2) + "|"]
    for name, row in figures["rows"].items():
        cells = [short(row[one], figures["unit"]) if one in row else "–" for one in columns]
        known = theirs.get(name)
        behind = f" ({known.about})" if known and known.about else ""
        lines.append(f"| {' | '.join([name, *cells, (_published(known) or '–') + behind])} |")
    return "\n".join(lines)


def _score(theirs: Mapping[str, Reference], path: str) -> str:
    parts = []
    for when in ("before", "after"):
        one = theirs.get(f"holdout.{when}.{path}")
        if one:
            behind = f" ({one.about})" if one.about else ""
            parts.append(f"{quantity_text(one.value, one.unit, one.sd)}{behind}")
    return "; ".join(parts)


def short(value: float | None, unit: str) -> str:
    """An error with three digits, with a smaller prefix where that reads better."""
    if value is None:
        return "not computable"
    for small in _SMALLER.get(unit, ()):
        if 0 < abs(value) < 0.1:
            value, unit = value * parse_unit(unit).factor / parse_unit(small).factor, small
    return quantity_text(value, unit, digits=3)


_SMALLER = {"m": ("mm",), "rad": ("mrad",), "V": ("mV",), "kN": ("N",)}
