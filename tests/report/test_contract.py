"""diagnosis.json: valid under the schema for every verdict, finite numbers only."""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from symhyb.discrepancy.results import Alternative, Diagnosis, Memory, RecordingFault, Verdict
from symhyb.errors import NumericsError
from symhyb.model.types import On
from symhyb.report import exit_status, to_json
from symhyb.report.contract import UNBOUNDED
from symhyb.report.schema import SCHEMAS, text_of
from symhyb.workbench.beside import compared_tables, result_tables
from symhyb.workbench.results import read_result

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]
SCHEMA = json.loads(resources.files("symhyb.report").joinpath("diagnosis.schema.json").read_text())


def test_every_verdict_is_valid_and_strict_json(case: tuple[Diagnosis, Verdict]) -> None:
    content = to_json(*case)
    jsonschema.validate(content, SCHEMA, jsonschema.Draft202012Validator)
    assert json.loads(json.dumps(content, allow_nan=False)) == content


def test_every_verdict_is_read_by_the_workbench(
    case: tuple[Diagnosis, Verdict], tmp_path: Path
) -> None:
    content = to_json(*case)
    (tmp_path / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
    result = read_result(tmp_path)
    assert (result.verdict, result.sentence) == (content["verdict"], content["sentence"])
    assert [law.name for law in result.laws] == [one["name"] for one in content["found"]]
    assert result_tables(result)
    assert compared_tables(result, result)


def unsaid(content: Any, schema: dict[str, Any], path: str = "") -> Iterator[str]:
    """The keys of ``content`` of which the schema says nothing."""
    for form in schema.get("anyOf", []):
        schema = schema | form
    if "$ref" in schema:
        schema = SCHEMA["$defs"][schema["$ref"].rpartition("/")[2]]
    if isinstance(content, list):
        for entry in content:
            yield from unsaid(entry, schema.get("items", {}), f"{path}[]")
    if isinstance(content, dict):
        said = schema.get("properties", {})
        free = schema.get("additionalProperties")
        for key, value in content.items():
            if key in said:
                yield from unsaid(value, said[key], f"{path}.{key}")
            elif not isinstance(free, dict):
                yield f"{path}.{key}"


def rich(cases: Cases) -> tuple[Diagnosis, Verdict]:
    """A diagnosis with everything that may stand in it."""
    diagnosis, verdict = cases["missing"]()
    partner = RecordingFault("sign", ("motor",))
    return replace(
        diagnosis,
        faults=(
            RecordingFault(
                "unit", ("encoder",), 1000.0, "mm", True, "encoder is in mm.", (partner,)
            ),
        ),
        memory=Memory(0.85, float("nan"), "The missing force remembers."),
        alternatives=(
            *diagnosis.alternatives,
            Alternative(None, "gap", (), 2.0, place=On("q"), options=(("side", "upper"),)),
        ),
    ), verdict


def test_the_schema_says_every_key_that_is_written(cases: Cases) -> None:
    content = to_json(*rich(cases))
    assert list(unsaid(content, SCHEMA)) == []
    assert list(unsaid(content | {"new": 1, "memory": {"more": 1}}, SCHEMA)) == [
        ".memory.more",
        ".new",
    ]
    jsonschema.validate(content, SCHEMA, jsonschema.Draft202012Validator)
    assert content["channels"][0]["rivals"] == [{"kind": "sign", "channels": ["motor"]}]
    assert content["memory"]["past"] is None


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("channels", [{"kind": "offset"}]),
        ("channels", {}),
        ("memory", {"state": 0.5}),
        ("format", 2),
        ("log", "a story"),
    ],
)
def test_the_schema_refuses_what_is_not_agreed(cases: Cases, key: str, value: object) -> None:
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(to_json(*rich(cases)) | {key: value}, SCHEMA)


@pytest.mark.parametrize("name", SCHEMAS)
def test_the_schemas_are_those_of_the_types(name: str) -> None:
    """``python -m symhyb.report.schema`` writes them."""
    assert resources.files("symhyb.report").joinpath(name).read_text("utf-8") == text_of(name)


def test_what_is_said_of_a_type_is_said_where_its_keys_are() -> None:
    place = SCHEMA["$defs"]["PlaceForm"]
    for entry in ({"on": "x"}, {"between": ["a", "b"]}):
        jsonschema.validate(entry, place)
    for entry in ({}, {"on": "x", "at": "p"}, {"between": ["a"]}, {"of": "x"}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(entry, place)


def test_found_effects_say_place_terms_and_numbers(cases: Cases) -> None:
    content = to_json(*cases["missing"]())
    friction, _, constant = content["found"]
    assert friction["place"] == {"on": "q"}
    assert friction["parameters"]["F_c"] == {
        "value": 20.41,
        "sd": 0.12,
        "unit": "N",
        "term": "coulomb",
    }
    assert constant["law"] == "constant"
    assert content["places"][1]["place"] == {"between": ["anchor", "tip"]}
    assert content["places"][0]["active"]["time"] == [[0.4, 5.6], [6.4, 11.6]]
    assert content["remainder"]["share"] == 0.0043
    assert content["format"] == 1
    assert content["log"]
    assert content["notes"]


def test_places_say_when_and_recordings_say_what_they_say_of_each_other(cases: Cases) -> None:
    content = to_json(*cases["missing"]())
    first, second = content["places"]
    assert first["change"]["time_s"] == 12.02
    assert first["band_hz"] == [1.1, 2.9]
    assert first["beyond"] is None
    assert "change" not in second
    assert content["misfits"][0]["recording"] == "c.csv"
    assert content["repeats"][0]["between"] == {"encoder": 0.02}


def test_scores_hold_every_kind_before_and_after(cases: Cases) -> None:
    scores = to_json(*cases["missing"]())["scores"]
    assert scores["window_s"] == 0.25
    assert scores["force_band_hz"] == 60.0
    assert scores["carries"].startswith("The errors over windows")
    assert scores["holdout"]["before"]["window_nrmse"] == {"encoder": 0.024}
    assert set(scores["train"]["after"]) == {
        "force_nrmse",
        "window_nrmse",
        "free_run_nrmse",
        "force_residual",
        "window_rmse",
        "free_run_rmse",
    }


def test_what_could_not_be_computed_is_null_or_unbounded(cases: Cases) -> None:
    content = to_json(*cases["failed"]())
    assert content["scores"]["train"]["before"]["window_nrmse"] == {"encoder": None}
    assert content["remainder"]["share"] is None
    assert content["noise"] == {}
    assert [row["explained"] for row in content["places"]] == [None, None]
    assert content["found"][0]["share"] is None
    assert content["found"][0]["parameters"]["F_c"]["sd"] == UNBOUNDED
    assert "stretch" not in content["found"][0]["active"]
    assert content["found"][0]["active"]["rate"] == [-0.1, 0.1]


def test_alternatives_name_exactly_one_cause(cases: Cases) -> None:
    place, channel, parameter = to_json(*cases["undecided"]())["alternatives"]
    named = {"place", "channel", "parameter"}
    assert [named & set(rival) for rival in (place, channel, parameter)] == [
        {"place"},
        {"channel"},
        {"parameter"},
    ]
    assert place["instead_of"] is None


def test_a_fitted_value_that_is_no_number_is_refused(cases: Cases) -> None:
    diagnosis, verdict = cases["parameters"]()
    broken = replace(diagnosis.parameters[0], value=float("nan"))
    with pytest.raises(NumericsError, match="k came out as nan"):
        to_json(replace(diagnosis, parameters=(broken,)), verdict)


def test_exit_status_is_zero_only_if_nothing_is_missing(cases: Cases) -> None:
    status = {name: exit_status(make()[0]) for name, make in cases.items()}
    assert status.pop("null") == 0
    assert set(status.values()) == {1}
