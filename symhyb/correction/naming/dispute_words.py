"""What is not claimed since its value depends on what else the structure holds, in words."""

from symhyb.correction.adequacy.agreement import Disputed
from symhyb.correction.naming.fleet_words import opening_of, unit_of_key
from symhyb.correction.search.trajectory import keys_of
from symhyb.discrepancy.words.amounts import small_text
from symhyb.model.types import Model

_BESIDE = {
    "coupling": "a coupling",
    "input": "another effect of the input",
    "lag": "a lag",
    "hidden mode": "a hidden mode",
    "law": "a smooth force of stretch and rate",
    "time-varying": "a number that changes",
    "sensor": "a fault of the sensor",
}


def dispute_sentence(model: Model, one: Disputed) -> str:
    """Both values, and what follows."""
    key = keys_of(one.cause)[0]
    unit = unit_of_key(model, one.cause, key)
    claimed, another = (
        small_text(value / unit.factor, unit.text, sd / unit.factor)
        for value, sd in (one.claimed, one.another)
    )
    beside = _BESIDE[one.beside.kind] if one.beside else "an unknown force"
    where = f" in {one.recording}" if one.recording else ""
    return (
        f"{opening_of(one.cause, key)}{where} would be {claimed}, and {another} beside {beside}: "
        "it only stands in for something else, and is not claimed."
    )
