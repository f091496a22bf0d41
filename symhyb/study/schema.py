"""The JSON Schema of study.toml: ``python -m symhyb.study.schema [FILE]`` writes it."""

import sys
from pathlib import Path

from symhyb.model.schema_parts import (
    DIALECT,
    Schema,
    listed,
    named,
    number,
    one_given,
    pair,
    positive,
    refer,
    table,
    text,
    truth,
    write,
)
from symhyb.study.file import FORMAT
from symhyb.study.sources import ORIGINS

FILE = Path(__file__).with_name("study.schema.json")


def study_schema() -> Schema:
    """The schema of a study file, format 1."""
    version = {"type": "integer", "const": FORMAT, "description": "version of the file format"}
    source = refer("recording")
    sections: dict[str, Schema] = {
        "symhyb": version,
        "title": text("of the report; unset, that of the model"),
        "about": text("text for people"),
        "model": text("the model file, relative to this file"),
        "map": _map("channel = column, for all recordings"),
        "own": _own(),
        "budget": text("time after which the diagnosis ends, with its unit, as 10min"),
        "train": listed("recordings to learn from", source, 1),
        "holdout": listed("unseen recordings, for the proof alone", source, 0),
        "score": _score(),
        "finish": _finish(),
        "fit": listed("the tasks of a sweep fit these numbers, and diagnose nothing", _name(), 0),
        "values": named("values of parameters, in place of those of the model", number("a value")),
        "noise": _noise(),
        "sweep": _sweep(),
    }
    models: Schema = {"properties": {"sweep": {"required": ["models"]}}, "required": ["sweep"]}
    return {
        "$schema": DIALECT,
        "title": "symhyb study file, format 1",
        **table(sections, ("symhyb", "train"), anyOf=[{"required": ["model"]}, models]),
        "definitions": {"recording": _recording()},
    }


def _map(about: str) -> Schema:
    column = text("a column, with its unit if need be, or an expression in columns")
    return named(about, column)


def _name() -> Schema:
    return text("a number of the model, as k or laser.gain")


def _own() -> Schema:
    each = listed("what every recording has its own value of", text("a parameter or a key"), 0)
    within = named("by parameter or key, within which groups it is shared", text("a grouping"))
    return {"anyOf": [each, within]}


def _recording() -> Schema:
    keys = {
        "file": text("a file, relative to this file"),
        "data": text("a public recording, as name/file"),
        "files": text("a pattern of names, as runs/*.csv: a recording for each file that fits"),
        "table": text("a CSV file with a row for each recording, in its column 'file' the name"),
        "span": pair("[start, end] in s; what lies outside is dropped"),
        "map": _map("entries of the map for this recording alone"),
        "parameters": named(
            "known values in this recording, in the units of the model",
            number("of a parameter of the model"),
        ),
        "groups": named("of which groups this recording is, by grouping", text("a group")),
    }
    return table(keys, oneOf=one_given(ORIGINS))


def _score() -> Schema:
    keys = {
        "window_s": positive("length of the windows, in s"),
        "force_band_hz": positive("end of the force band, in Hz"),
    }
    return table(keys, description="how scores are made")


def _finish() -> Schema:
    keys = {
        "values": truth("fit every uncertain number of the corrected model once more"),
        "remainder": text("a coordinate: add a smooth force for what the named laws leave there"),
        "network": text("a coordinate: train a network for what the named laws leave there"),
    }
    return table(keys, description="what is done once the causes are named")


def _noise() -> Schema:
    keys = {
        "level": number("as a part of the standard deviation of each sensor", minimum=0),
        "seed": _whole("of the random numbers", 0),
    }
    return table(keys, ("level",), description="white noise, added to the training recordings")


def _sweep() -> Schema:
    subsets = {
        "size": _whole("training recordings in each", 1),
        "count": _whole("how many subsets", 1),
        "seed": _whole("of the random choice", 0),
    }
    levels = number("as a part of the standard deviation of each sensor", minimum=0)
    noise = {
        "levels": listed("of added noise", levels, 1, uniqueItems=True),
        "seeds": listed("of the random numbers", _whole("a seed", 0), 1, uniqueItems=True),
    }
    options = {
        "name": text("what the results call it"),
        "map": _map("channel = column, in place of the map of the study"),
        "own": _own(),
        "score": _score(),
        "finish": _finish(),
    }
    structures = {
        "name": text("what the results call it"),
        "fit": listed("its numbers, beside those that all structures fit", _name(), 1),
        "values": named("where numbers stand in it, in the units of the model", number("a value")),
    }
    values = listed("each of these", number("a value"), 1, uniqueItems=True)
    keys = {
        "models": listed("model files", text("a model file"), 1, uniqueItems=True),
        "each": text("'recording', or a grouping: a diagnosis for each, or for each of its groups"),
        "values": named("by parameter, in the units of the model: a grid", values),
        "subsets": table(subsets, ("size", "count"), description="random training recordings"),
        "noise": table(noise, ("levels",), description="noise, added to the training recordings"),
        "options": listed("sets of options", table(options, ("name",)), 1),
        "structures": listed(
            "of tasks that fit: structures that each of them compares",
            table(structures, ("name",)),
            2,
        ),
    }
    return table(keys, minProperties=1, description="many diagnoses of one study: what is varied")


def _whole(about: str, least: int) -> Schema:
    return {"type": "integer", "minimum": least, "description": about}


def main() -> None:
    """Write the schema to the file that is named, else to the one that is shipped."""
    write(study_schema(), Path(sys.argv[1]) if len(sys.argv) > 1 else FILE)


if __name__ == "__main__":
    main()
