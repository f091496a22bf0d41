"""The report as one self-contained HTML page: sentences first, then pictures, then tables."""

from collections.abc import Iterable, Mapping
from importlib import resources

from jinja2 import Environment, FunctionLoader, StrictUndefined, Template

from symhyb.discrepancy.checks.first_checks import FirstChecks
from symhyb.discrepancy.results import Diagnosis, Verdict
from symhyb.discrepancy.words.wording import (
    grouped_alternatives,
    measurement_phrases,
    parameter_phrase,
)
from symhyb.model.types import Model
from symhyb.report import pictures
from symhyb.report.apart import apart_sentence
from symhyb.report.doubts import correlations_sentence, whiteness_sentences
from symhyb.report.embed import embedded
from symhyb.report.rivals import rival_sentence
from symhyb.report.sentences import (
    alternative_sentence,
    method_sentences,
    remainder_sentence,
    score_sentences,
    typeset,
)
from symhyb.report.tables import place_table, tables
from symhyb.report.worth import certainty, headline, worth_sentence


def render_page(
    title: str,
    diagnosis: Diagnosis,
    verdict: Verdict,
    difference: str = "",
    provenance: Mapping[str, str] | None = None,
    model: Model | None = None,
    first: FirstChecks | None = None,
) -> str:
    """Write the report as HTML that needs no other file and no network.

    ``difference`` is the text of the model diff, ``provenance`` says what the result was made from
    (files, SHA-256, versions). ``model`` gives the units in which sensors and places are shown;
    without it they are shown in SI. ``first`` are the first checks of a training recording.
    """
    units = {} if model is None else {sensor.name: sensor.unit for sensor in model.sensors}
    texts = {name: unit.text for name, unit in units.items()}
    shown = pictures.shown_recordings(
        verdict, units, diagnosis.noise, pictures.clouds_over_time(diagnosis, model)
    )
    white = pictures.first_whiteness(verdict)
    known = diagnosis.correlations
    machine = pictures.machine_picture(diagnosis, model)
    motion = None if machine is None else pictures.machine_motion(diagnosis, verdict, model)
    return template("page.html.j2").render(
        title=title,
        diagnosis=diagnosis,
        verdict=verdict,
        headline=headline(verdict, texts),
        certainty=certainty(diagnosis),
        worths=[worth_sentence(effect, verdict, texts) for effect in diagnosis.found],
        besides=[f"{phrase}." for phrase in _besides(diagnosis)],
        machine_picture=machine,
        machine_motion=motion,
        alternatives=[
            alternative_sentence(*group) for group in grouped_alternatives(diagnosis.alternatives)
        ],
        scores=score_sentences(verdict, texts),
        remainder=remainder_sentence(diagnosis.remainder),
        methods=method_sentences(verdict),
        shown=shown,
        embedded=embedded([one.live for one in shown], None if motion is None else motion.data),
        clouds=pictures.cloud_pictures(diagnosis, verdict, model),
        white=whiteness_sentences(white),
        white_picture=pictures.whiteness_picture(verdict),
        correlations_picture=pictures.correlations_picture(diagnosis),
        correlations_sentence=known and correlations_sentence(known),
        first=first,
        first_picture=first and pictures.first_picture(first),
        score_picture=pictures.score_picture(verdict),
        place_picture=pictures.place_picture(diagnosis),
        courses=pictures.course_pictures(diagnosis),
        apart_picture=pictures.apart_picture(diagnosis),
        apart_sentence=diagnosis.isolability and apart_sentence(diagnosis.isolability),
        rivals_picture=pictures.rivals_picture(diagnosis, units),
        rivals=[rival_sentence(one) for one in diagnosis.rivals],
        omitted=_omitted(diagnosis, verdict),
        corrected=any(
            scores.before != scores.after for scores in (verdict.train, verdict.holdout) if scores
        ),
        tables=[table for table in tables(diagnosis, verdict, units) if table.rows],
        places=place_table(diagnosis, model),
        occurrences=pictures.occurrence_pictures(diagnosis, model),
        difference=difference.strip("\n").splitlines(),
        provenance=dict(provenance or {}),
    )


def template(name: str) -> Template:
    """A page of this package, whose text is escaped and typeset."""
    folder = resources.files("symhyb.report")
    loader = FunctionLoader(lambda file: folder.joinpath(file).read_text("utf-8"))
    pages = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, loader=loader)
    pages.filters["typeset"] = typeset
    return pages.get_template(name)


def _besides(diagnosis: Diagnosis) -> Iterable[str]:
    yield from map(parameter_phrase, diagnosis.parameters)
    yield from measurement_phrases(diagnosis.measurement)


def _omitted(diagnosis: Diagnosis, verdict: Verdict) -> list[str]:
    """Sentences on what has no picture: it is too much, or it holds no values."""
    traces = sum(len(trace.measured) for trace in verdict.traces) - len(
        pictures.drawn_traces(verdict)
    )
    clouds = len(diagnosis.clouds) - len(pictures.drawn_clouds(diagnosis))
    return [
        sentence
        for count, sentence in (
            (traces, f"Not drawn here, but in simulation.csv: {traces} more measured signals."),
            (clouds, f"Not drawn here: the force at {clouds} more places and recordings."),
        )
        if count
    ]
