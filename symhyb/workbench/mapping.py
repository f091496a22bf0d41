"""Which column is which channel, as choices to select from, and the lines that say so elsewhere."""

import json
import shlex
from collections.abc import Iterator
from dataclasses import dataclass

from symhyb.data.columns import channels_of
from symhyb.data.files.table import Table
from symhyb.discrepancy.words.amounts import unit_text
from symhyb.workbench.bench import Bench

BY_NAME = ""
"""The choice that leaves a channel to the column of its name."""


@dataclass(frozen=True, slots=True)
class Choice:
    """A channel of the model with the column that it is taken from: ``chosen`` by a person (empty:
    by its name, which finds the column ``found``, None where there is none). ``offered`` are pairs
    of a column and what it is called."""

    role: str
    name: str
    unit: str
    chosen: str
    found: str | None
    offered: tuple[tuple[str, str], ...]

    @property
    def title(self) -> str:
        """The channel with its role and unit."""
        return f"{self.role} {self.name} [{unit_text(self.unit) or '1'}]".lstrip()


def choices(bench: Bench) -> tuple[Choice, ...]:
    """What may be chosen for every channel of the model, time first."""
    asked, columns = dict(bench.columns), tuple(_usable(bench.table))
    made = []
    for channel, found in channels_of(bench.table, bench.model):
        chosen = asked.get(channel.name, BY_NAME)
        named = "by its name" if found is None else f"by its name: {found}"
        if found is None:
            named = "none has its name"
        own = () if chosen in (BY_NAME, *columns) else (chosen,)  # an expression in columns
        offered = ((BY_NAME, named), *((one, one) for one in (*own, *columns)))
        role = "" if channel.role == "time" else channel.role
        name = "time" if channel.role == "time" else channel.name
        made.append(Choice(role, name, channel.unit.text, chosen, found, offered))
    return tuple(made)


def channel_names(bench: Bench) -> tuple[str, ...]:
    """The channels in the order of `choices`, as a map calls them."""
    return tuple(channel.name for channel, _ in channels_of(bench.table, bench.model))


def map_lines(bench: Bench) -> str:
    """The map as options of the command line and as a table of a study file, to be copied; empty
    where every channel is found by its name."""
    if not bench.columns:
        return ""
    options = " ".join(f"--map {shlex.quote(f'{a}={b}')}" for a, b in bench.columns)
    entries = "\n".join(f"{a} = {json.dumps(b, ensure_ascii=False)}" for a, b in bench.columns)
    return f"# command line\n{options}\n\n# study.toml\n[map]\n{entries}\n"


def _usable(table: Table) -> Iterator[str]:
    """The headers of the columns that hold numbers, each once."""
    for column in table.columns:
        if column.problem is None and column.values.size:
            yield column.header
