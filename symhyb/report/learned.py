"""What was learned, for people and for scripts: ``learned.json``, and one HTML page."""

import json
from collections.abc import Mapping
from typing import Any, Literal

from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.discrepancy.words.wording import number_text, quantity_text
from symhyb.learning import Learned, LearnedTerm
from symhyb.numeric.lowered.network import stored
from symhyb.report.contract import finite, scores_json
from symhyb.report.embed import embedded
from symhyb.report.learned_document import BesideEntry, LearnedDocument, TermEntry
from symhyb.report.page import template
from symhyb.report.pictures import score_picture, shown_recordings
from symhyb.report.sentences import method_sentences, score_sentences
from symhyb.report.tables import Table, score_table
from symhyb.report.worth import headline

FORMAT: Literal[1] = 1
_OF_A_DIAGNOSIS = ("Share of", "Stays chosen")  # scores that only it has


def learned_json(
    learned: Learned,
    manifest: Mapping[str, Any] | None = None,
    beside: tuple[Diagnosis, Verdict] | None = None,
) -> LearnedDocument:
    """Give what was learned as plain mappings, lists, text and finite numbers; docs/learn.md states
    every key. ``beside`` is the answer of a diagnosis of the same recordings.

    Raises:
        NumericsError: a number that came out is not finite.
    """
    held = learned.worth
    return {
        "format": FORMAT,
        "by": learned.by,
        "formulation": learned.formulation,
        "learned": learned.something,
        "sentence": learned.sentence,
        "file": None if learned.corrected is None else "corrected.toml",
        "terms": [_term(one) for one in learned.terms],
        "networks": [
            {
                "place": {"on": one.on},
                "inputs": list(one.inputs),
                "hidden": int(one.weights.layers[0].bias.size),
                "trust": [[low, high] for low, high in one.trust],
                "element": None if one.element is None else one.element.name,
                "sentence": one.sentence,
                "weights": None if one.element else json.loads(stored(one.weights)),
            }
            for one in learned.networks
        ],
        "held": None
        if held is None
        else {
            "nothing": finite(held.nothing),
            "learned": finite(held.learned),
            "better": held.better,
        },
        "scores": scores_json(learned.verdict),
        "settings": dict(learned.settings),
        "notes": list(learned.notes),
        "beside": None if beside is None else _beside(*beside),
        "manifest": dict(manifest or {}),
    }


def render_learned(
    title: str,
    learned: Learned,
    difference: str = "",
    provenance: Mapping[str, str] | None = None,
    beside: tuple[Diagnosis, Verdict] | None = None,
) -> str:
    """Write what was learned as HTML that needs no other file and no network."""
    model, verdict = learned.model, learned.verdict
    units = {sensor.name: sensor.unit for sensor in model.sensors}
    texts = {name: unit.text for name, unit in units.items()}
    shown = shown_recordings(verdict, units)
    other = None
    if beside is not None:
        other = {"sentence": beside[0].sentence, "scores": score_sentences(beside[1], texts)}
    return template("learned.html.j2").render(
        title=title or "Learned",
        heading="Learned" if learned.something else "Nothing learned",
        learned=learned,
        equations=[one.formula for one in learned.terms],
        scores=score_sentences(verdict, texts),
        methods=[one for one in method_sentences(verdict) if not one.startswith(_OF_A_DIAGNOSIS)],
        headline=headline(verdict, texts),
        shown=shown,
        embedded=embedded([one.live for one in shown]),
        score_picture=score_picture(verdict),
        tables=[t for t in (_term_table(learned), score_table(verdict, units)) if t.rows],
        settings={name: _shown(value) for name, value in learned.settings},
        beside=other,
        difference=difference.strip("\n").splitlines(),
        provenance=dict(provenance or {}),
    )


def _term(one: LearnedTerm) -> TermEntry:
    return {
        "place": {"on": one.coordinate},
        "term": one.term,
        "words": one.words,
        "formula": one.formula,
        "value": finite(one.value),
        "sd": finite(one.sd),
        "unit": one.unit,
        "regressed": finite(one.regressed),
        "element": one.element or None,
    }


def _beside(diagnosis: Diagnosis, verdict: Verdict) -> BesideEntry:
    """What a diagnosis says of the same recordings; all of it is in diagnosis.json."""
    return {
        "verdict": diagnosis.verdict,
        "sentence": diagnosis.sentence,
        "found": [
            {"name": one.element.name, "kind": one.element.kind, "sentence": one.sentence}
            for one in diagnosis.found
        ],
        "scores": scores_json(verdict),
    }


def _term_table(learned: Learned) -> Table:
    return Table(
        "Learned terms",
        ("coordinate", "term", "value", "regressed", "element"),
        tuple(
            (
                one.coordinate,
                one.term,
                quantity_text(one.value, one.unit, one.sd),
                number_text(one.regressed),
                one.element,
            )
            for one in learned.terms
        ),
        (2, 3),
    )


def _shown(value: object) -> str:
    return ", ".join(map(str, value)) or "default" if isinstance(value, list) else str(value)
