"""How a study is carried out: what its file, or one set of options of its sweep, says of it."""

from collections.abc import Sequence
from typing import Any

from symhyb.data.groups import by_name
from symhyb.model.tables import Table, describe
from symhyb.study.sources import text_map

KEYS = ("map", "own", "score", "finish")

Options = dict[str, Any]
"""By the field of :class:`~symhyb.study.file.Study` its value."""


def read_options(table: Table) -> Options:
    """The fields of a study that a table states; what is wrong becomes a fault of it."""
    stated: Options = {}
    columns = text_map(table, "map")
    if columns is not None:
        stated["columns"] = columns
    if "own" in table.entries:
        stated["own"] = _own(table)
    score = _inner(table, "score", ("window_s", "force_band_hz"))
    if score is not None:
        stated |= {key: _positive(score, key) for key in ("window_s", "force_band_hz")}
    finish = _inner(table, "finish", ("values", "remainder", "network"))
    if finish is not None:
        stated["last_values"] = finish.truth("values")
        stated |= {key: finish.text(key) for key in ("remainder", "network")}
    return stated


def _inner(table: Table, key: str, keys: Sequence[str]) -> Table | None:
    inner = table.table(key)
    return None if inner is None else inner.checked(keys)


def _own(table: Table) -> dict[str, str]:
    """The names of what not all recordings share, each with the grouping of those that do."""
    stated: Any = table.entries["own"]
    listed = list(stated.values()) if isinstance(stated, dict) else stated
    if not isinstance(listed, list) or not all(isinstance(name, str) for name in listed):
        text = (
            'must be a list of names, like ["m", "drag"], or say within which groups each is '
            f'shared, like {{ drag = "mount" }}, not {describe(stated)}'
        )
        table.fault(text, "own")
        return {}
    return by_name(stated)


def _positive(table: Table, key: str) -> float | None:
    value = table.number(key)
    if value is not None and value <= 0:
        table.fault(f"must be positive, not {value:g}", key)
    return value
