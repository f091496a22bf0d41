"""Read what a model file says of a trained force law: its file, hash, inputs and trust box."""

import re

from symhyb.model.beside import named_file
from symhyb.model.expression import Expression
from symhyb.model.tables import Table, describe, shorten
from symhyb.model.types import Network

NETWORK_KEYS = ("weights", "sha256", "inputs", "trust")


def read_network(table: Table) -> Network | None:
    """Read the keys of a network, None if one of them is missing or wrong."""
    weights = named_file(table, "weights", required=True)
    digest = table.text("sha256", required=True)
    if digest is not None and not re.fullmatch(r"[0-9a-fA-F]{64}", digest):
        table.fault(f"must be 64 hexadecimal digits, not '{shorten(digest)}'", "sha256")
        digest = None
    inputs, trust = _seen(table), _trust(table)
    if inputs and trust and len(inputs) != len(trust):
        table.fault(f"has {len(trust)} ranges for {len(inputs)} inputs; give one each", "trust")
    if weights is None or digest is None or not inputs or not trust:
        return None
    return Network(weights, digest.lower(), inputs, trust)


def _seen(table: Table) -> tuple[Expression, ...]:
    """Read the expressions that a network sees, empty if one of them is wrong."""
    given = table.entries.get("inputs")
    if table.lacks("inputs"):
        table.fault("'inputs' is missing: a list of expressions that the network sees")
        return ()
    if not isinstance(given, list) or not given:
        if given is not None:
            table.fault(f"must be a list of expressions, not {describe(given)}", "inputs")
        return ()
    found = [table.as_expression(item, "inputs") for item in given]
    return () if None in found else tuple(item for item in found if item)


def _trust(table: Table) -> tuple[tuple[float, float], ...]:
    """Read the box of the training, one [low, high] for each input."""
    given = table.entries.get("trust")
    if table.lacks("trust"):
        table.fault("'trust' is missing: a list of [low, high], one for each input")
        return ()
    if not isinstance(given, list) or not given:
        if given is not None:
            table.fault(f"must be a list of [low, high], not {describe(given)}", "trust")
        return ()
    box: list[tuple[float, float]] = []
    for item in given:
        ends = table.numbers(item, "trust", 2, "[low, high]")
        if ends is None:
            return ()
        if not ends[0] < ends[1]:
            table.fault(f"[{ends[0]:g}, {ends[1]:g}] is empty: low must be below high", "trust")
            return ()
        box.append((ends[0], ends[1]))
    return tuple(box)
