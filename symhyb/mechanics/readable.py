"""M, k_c and k_e in SymPy, each summand with what it comes from: what ``symhyb equations`` prints.

Here SymPy differentiates what :mod:`symhyb.numeric.lowered.translate` leaves to CasADi. A small
model is tidied; in a large one the derivatives of positions and all that recurs have names, and
nothing is multiplied out.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import sympy as sp

from symhyb.mechanics.constraints import Closure, closures
from symhyb.mechanics.equations import Equations, derive
from symhyb.mechanics.inertia import (
    Tidy,
    declared_rows,
    effort,
    gravity_rows,
    kinetic_rows,
    moving_parts,
    named_motion,
)
from symhyb.mechanics.pathways import force_rows, inner_rates, named_pathways, short_of
from symhyb.mechanics.rows import Named, Row, Side, Slopes
from symhyb.mechanics.spinning import (
    length_rows,
    named_turning,
    spin_effort,
    spin_rows,
    spinning_bodies,
)
from symhyb.mechanics.symbols import Symbols
from symhyb.mechanics.tidy import exact, named, tidied
from symhyb.model.closed import require_open
from symhyb.model.expression import Reading
from symhyb.model.types import Model

MOST_TIDIED = 2_000  # terms of M and k_c that are tidied
_PLAIN = ("slope", "pull", "bias", "turn")
LONGEST = 2_500  # operations of a whole model without names for what recurs


@dataclass(frozen=True, slots=True)
class Readable:
    """The equations of a model as they are printed, coherent SI. ``inner`` holds the rate of each
    declared state and each inner state by its symbol; ``names`` come after those they use; ``gaps``
    are what constraints hold at zero, by forces Jᵀλ beside k_e. ``sampled`` holds the next value of
    each declared state that is sampled, and the time between two samples, s."""

    symbols: Symbols
    rows: tuple[Row, ...]
    inner: tuple[tuple[sp.Symbol, sp.Expr], ...]
    outputs: tuple[sp.Expr, ...]
    readings: tuple[Reading, ...]
    names: tuple[Named, ...]
    gaps: tuple[Closure, ...] = ()
    sampled: tuple[tuple[sp.Symbol, sp.Expr, float], ...] = ()

    def of(self, side: Side, *index: int) -> tuple[Row, ...]:
        """The rows of one side of one coordinate, or of one entry of M."""
        return tuple(row for row in self.rows if (row.side, row.of) == (side, index))


def readable(model: Model, matrices: bool = False) -> Readable:
    """Derive the equations of a checked model for reading.

    One row for each coordinate, side and source; with ``matrices`` one row for each entry of M (on
    and above the diagonal), k_c and k_e, summed over the sources. Rows that are zero are left out.

    Raises:
        InputError: the model is an FMU, which has none.
    """
    require_open(model)
    equations: Equations = exact(derive(model))
    slopes, parts = Slopes(equations.symbols), moving_parts(equations)
    turning = spinning_bodies(equations, slopes)
    small = effort(parts, slopes) + spin_effort(turning) <= MOST_TIDIED
    tidy: Tidy = tidied if small else _as_it_is
    pathways = named_pathways(model, equations, slopes)
    motion = () if small else named_motion(model, parts, slopes)
    lengths = short_of(pathways)
    short = {**lengths, **{item.value: item.symbol for item in motion}}
    turns = () if small else named_turning(model, turning)
    spins = {item.value: item.symbol for item in turns}
    motion = tuple(replace(item, value=item.value.xreplace(lengths)) for item in motion)
    rows = (
        *_joined(
            (
                *kinetic_rows(parts, slopes, tidy, short, matrices),
                *spin_rows(turning, equations.symbols.a, tidy, spins, matrices),
            ),
            tidy,
        ),
        *declared_rows(model, equations, slopes, tidy, matrices),
        *gravity_rows(equations, slopes, tidy, short),
        *length_rows(equations, slopes),
        *force_rows(model, equations, slopes, pathways),
    )
    rows = _summed(rows, tidy) if matrices else rows
    shown = tuple(row for row in rows if row.value != 0)
    declared = tuple(
        zip(
            model.states,
            equations.symbols.states,
            equations.rates,
            equations.nexts,
            strict=True,
        )
    )
    states = ((symbol, rate) for one, symbol, rate, _ in declared if one.next is None)
    sampled = tuple(
        (symbol, after, one.every) for one, symbol, _, after in declared if one.next is not None
    )
    inner = (*states, *inner_rates(model, equations, slopes, pathways))
    values = [*(row.value for row in shown), *(rate for _, rate in inner)]
    names = _needed((*motion, *turns, *pathways), values)
    gaps = exact(closures(model, equations.places, equations.symbols))
    return _shortened(
        Readable(
            equations.symbols,
            shown,
            inner,
            equations.outputs,
            equations.readings,
            names,
            gaps,
            sampled,
        )
    )


def _as_it_is(expression: sp.Expr) -> sp.Expr:
    return expression


def _joined(rows: tuple[Row, ...], tidy: Tidy) -> tuple[Row, ...]:
    """One row for each entry and source: a body in space has one of its centre, one of its turn."""
    found: dict[tuple[Side, tuple[int, ...], str], list[sp.Expr]] = {}
    for row in rows:
        found.setdefault((row.side, row.of, row.source), []).append(row.value)
    return tuple(
        Row(*key, values[0] if len(values) == 1 else tidy(sp.Add(*values)))
        for key, values in found.items()
    )


def _summed(rows: tuple[Row, ...], tidy: Tidy) -> tuple[Row, ...]:
    """One row for each entry, whatever it comes from."""
    found: dict[tuple[Side, tuple[int, ...]], list[sp.Expr]] = {}
    for row in rows:
        found.setdefault((row.side, row.of), []).append(row.value)
    return tuple(
        Row(side, of, "", sp.Add(*values) if side == "k_e" else tidy(sp.Add(*values)))
        for (side, of), values in found.items()
    )


def _needed(names: tuple[Named, ...], values: list[sp.Expr]) -> tuple[Named, ...]:
    """The names that something uses, those that other names use among them."""
    used = {symbol for value in values for symbol in value.free_symbols}
    return tuple(_in_order(names, used))


def _in_order(names: tuple[Named, ...], used: set[sp.Symbol]) -> Iterator[Named]:
    """Follow names depth first, so that each comes after those it uses."""
    place = {item.symbol: i for i, item in enumerate(names)}
    uses = [sorted(place[x] for x in item.value.free_symbols if x in place) for item in names]
    done: set[int] = set()
    waiting = sorted((place[symbol] for symbol in used if symbol in place), reverse=True)
    while waiting:
        at = waiting.pop()
        before = [other for other in uses[at] if other not in done]
        if before:
            waiting += [at, *reversed(before)]
        elif at not in done:
            done.add(at)
            yield names[at]


def _shortened(full: Readable) -> Readable:
    """Name what recurs if the whole is long."""
    values = [*(x.value for x in full.names), *(x.value for x in full.rows)]
    values += [rate for _, rate in full.inner]
    if sum(map(sp.count_ops, values)) <= LONGEST:
        return full
    taken = {symbol.name for value in values for symbol in value.free_symbols}
    plain = {item.symbol for item in full.names if item.kind.split()[-1] in _PLAIN}
    # a row in terms of named motion is short: names for its products would hide what it says
    held = [bool(row.value.free_symbols & plain) for row in full.rows]
    long = [row.value for row, kept in zip(full.rows, held, strict=True) if not kept]
    parts, short = named(
        [*(item.value for item in full.names), *(rate for _, rate in full.inner), *long], taken
    )
    rest = iter(short)
    names = [replace(item, value=next(rest)) for item in full.names]
    inner = tuple((name, next(rest)) for name, _ in full.inner)
    rows = tuple(
        row if kept else replace(row, value=next(rest))
        for row, kept in zip(full.rows, held, strict=True)
    )
    names += [Named(symbol, value) for symbol, value in parts]
    used = [*(row.value for row in rows), *(rate for _, rate in inner)]
    return _renumbered(replace(full, rows=rows, inner=inner, names=_needed(tuple(names), used)))


def _renumbered(full: Readable) -> Readable:
    """Count the names of recurring parts in the order in which they are printed."""
    old = [item.symbol for item in full.names if item.kind == "part"]
    new = dict(zip(old, sorted(old, key=lambda symbol: int(symbol.name[1:])), strict=True))
    return replace(
        full,
        rows=tuple(replace(row, value=row.value.xreplace(new)) for row in full.rows),
        inner=tuple((name, rate.xreplace(new)) for name, rate in full.inner),
        names=tuple(
            replace(x, symbol=new.get(x.symbol, x.symbol), value=x.value.xreplace(new))
            for x in full.names
        ),
    )
