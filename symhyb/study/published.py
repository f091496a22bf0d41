"""What others published on a recording: shown beside what was found, and never judged.

"published": {
  "source": "who, where",
  "says": "what is no number",
  "found": {"x.coulomb": {"value": 20.3935, "unit": "N", "sd": 0.1, "about": "Fc"}},
  "scores": {"holdout.after.window_rmse.encoder": {"value": 0.052, "unit": "mm"}}
}
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from symhyb.model.tables import Table
from symhyb.units import UnitError, parse_unit


@dataclass(frozen=True, slots=True)
class Reference:
    """A number that others published, in ``unit``; ``about`` says which."""

    value: float
    unit: str
    sd: float | None = None
    about: str = ""


@dataclass(frozen=True, slots=True)
class Published:
    """What others published on a recording: numbers by place.term and by path of a score, and
    in words what is no number. It stands beside what was found and is never judged."""

    source: str
    says: str
    found: Mapping[str, Reference]
    scores: Mapping[str, Reference]


def read_published(root: Table) -> Published | None:
    """Read the table ``published`` of an ``expected.json``; faults go to the list of the table."""
    table = root.table("published")
    if table is None:
        return None
    table = table.checked(("source", "says", "found", "scores"))
    return Published(
        table.text("source", True) or "",
        table.text("says") or "",
        dict(_references(table, "found")),
        dict(_references(table, "scores")),
    )


def _references(root: Table, key: str) -> Iterator[tuple[str, Reference]]:
    around = root.table(key)
    for name in around.entries if around else ():
        table = around.table(name) if around else None
        if table is None:
            continue
        table = table.checked(("value", "sd", "unit", "about"))
        value, unit = table.number("value", True), table.text("unit", True)
        try:
            parse_unit(unit or "1")
        except UnitError as error:
            table.fault(str(error), "unit")
        if value is not None and unit is not None:
            yield name, Reference(value, unit, table.number("sd"), table.about())
