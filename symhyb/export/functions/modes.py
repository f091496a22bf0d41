"""Laws that jump, made ready for solvers that know no jumps: smoothed, or in one mode at a time.

A mode is a number that stays while a solver integrates; indicators show when it has to change.
With the argument a that decides a mode, and a play h about its limits against chatter:

    3 modes   a = x/w of a jump sgn x over the half width w      sgn x -> m + (1 − m²)·a

        force      ___ +1      upper = a − 1 ∓ h > 0:  m = +1
                  /            lower = a + 1 ± h ≤ 0:  m = −1      (∓: farther out by h from
              ___/  0          else               m = 0             within, nearer from outside)
              -1

    2 modes   one indicator a ∓ h > 0: m = 1, else 0
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import casadi as ca

from symhyb.numeric.kernels.instructions import NOTHING, UNARY, Program, program

SMOOTHING = 1e-3  # SI: width over which a jump of sgn is passed
BAND_PLAY = 1e-6  # of the half width
STOP_PLAY = 1e-12  # m
NARROWEST = 1e-9  # SI: a jump that is to be in modes takes at least this half width

Names = tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """Modes m (M, 1) by ``symbols`` and the ``arguments`` (M, 1) that indicate them; ``names``
    for people and ``ways``, how many modes each can be in: 2 or 3."""

    symbols: ca.SX
    arguments: ca.SX
    names: tuple[str, ...] = ()
    ways: tuple[int, ...] = ()

    def that_matter(self, results: ca.SX) -> "Modes":
        """Those that ``results`` depend on, and those that decide these."""
        seen = results
        while True:
            flags = ca.sum1(ca.DM(ca.jacobian_sparsity(seen, self.symbols), 1)).full().reshape(-1)
            used = [i for i, flag in enumerate(flags) if flag]
            wider = ca.vertcat(results, self.arguments[used])
            if wider.numel() == seen.numel():
                return self._only(used)
            seen = wider

    def _only(self, used: Sequence[int]) -> "Modes":
        return Modes(
            ca.vertcat(ca.SX(0, 1), *(self.symbols[i] for i in used)),
            ca.vertcat(ca.SX(0, 1), *(self.arguments[i] for i in used)),
            tuple(self.names[i] for i in used),
            tuple(self.ways[i] for i in used),
        )

    def indicators(self) -> tuple[ca.SX, tuple[str, ...]]:
        """The indicators (I, 1) and their names: two for 3 modes, the upper one first, else one."""
        rows, names = list[ca.SX](), list[str]()
        for i, (name, ways) in enumerate(zip(self.names, self.ways, strict=True)):
            m, a = self.symbols[i], self.arguments[i]
            if ways == 2:
                rows.append(a + STOP_PLAY * (2 * m - 1))
                names.append(name)
            else:
                rows.append(a - 1 + BAND_PLAY * (m**2 + m - 1))
                rows.append(a + 1 - BAND_PLAY * (m**2 - m - 1))
                names += [f"{name}.upper", f"{name}.lower"]
        return ca.vertcat(ca.SX(0, 1), *rows), tuple(names)


@dataclass(frozen=True, slots=True, eq=False)
class Calmed:
    """``rates`` and ``y`` without a jump, indicators behind the latter; ``more`` parameters that
    they depend on, with ``names`` (kind, name) and ``values``; the ``deciding`` outputs
    and in how many ``ways`` each mode, the last parameters, can be."""

    rates: ca.SX
    y: ca.SX
    more: ca.SX
    names: Names = ()
    values: tuple[float, ...] = ()
    deciding: Names = ()
    ways: tuple[int, ...] = ()


def calmed(arguments: list[ca.SX], rates: ca.SX, y: ca.SX, modes: Modes | None) -> Calmed:
    """Functions of ``arguments`` without a jump of sgn: in modes, behind those that are known, or
    smoothed where that is None."""
    width = ca.SX.sym("width")
    if modes is None:
        smooth = _smoothed(ca.Function("f", arguments, [rates, y], {"cse": True}), arguments, width)
        if smooth is None:
            return Calmed(rates, y, ca.SX(0, 1))
        return Calmed(smooth[0], smooth[1], width, (("p", "smoothing"),), (SMOOTHING,))
    known, arguments = len(modes.names), [*arguments, modes.symbols]
    function = ca.Function("f", arguments, [rates, y, modes.arguments], {"cse": True})
    (rates, y), modes = _in_modes(function, arguments, width, modes)
    indicators, labels = modes.indicators()
    jumps = len(modes.names) > known
    return Calmed(
        rates,
        ca.vertcat(y, indicators),
        ca.vertcat(width, modes.symbols) if jumps else modes.symbols,
        (*((("p", "smoothing"),) if jumps else ()), *(("mode", name) for name in modes.names)),
        (*((SMOOTHING,) if jumps else ()), *(0.0 for _ in modes.names)),
        tuple(("event", label) for label in labels),
        modes.ways,
    )


def _smoothed(function: ca.Function, arguments: list[ca.SX], width: ca.SX) -> list[ca.SX] | None:
    """The results with tanh(x/width) for sgn x, None where no sgn occurs; width 0 is exact.

    A solver that meets a jump makes its steps smaller and smaller and stops."""
    steps = program(function)
    if steps is None or ca.OP_SIGN not in steps.operations():
        return None

    def soft(x: ca.SX) -> ca.SX:
        return ca.if_else(width > 0, ca.tanh(x / ca.fmax(width, 1e-300)), ca.sign(x))

    return _rewritten(steps, arguments, soft)


def _in_modes(
    function: ca.Function, arguments: list[ca.SX], width: ca.SX, known: Modes
) -> tuple[list[ca.SX], Modes]:
    """The results with a mode for each sgn, and these modes behind those that are ``known``, whose
    arguments are the last result of ``function``."""
    steps = program(function)
    if steps is None:
        raise TypeError("laws that are to be in modes are made of scalar operations")
    symbols, deciding = list[ca.SX](), list[ca.SX]()

    def banded(x: ca.SX) -> ca.SX:
        symbols.append(ca.SX.sym(f"m{len(symbols)}"))
        deciding.append(x / ca.fmax(width, NARROWEST))
        return symbols[-1] + (1 - symbols[-1] ** 2) * deciding[-1]

    *results, before = _rewritten(steps, arguments, banded)
    names = tuple(f"sign[{i + 1}]" for i in range(len(symbols)))
    return results, Modes(
        ca.vertcat(known.symbols, *symbols),
        ca.vertcat(before, *deciding),
        (*known.names, *names),
        (*known.ways, *(3 for _ in names)),
    )


def _rewritten(
    steps: Program, arguments: list[ca.SX], jump: Callable[[ca.SX], ca.SX]
) -> list[ca.SX]:
    """The results of a program at these arguments, with ``jump`` in place of sgn."""
    held: dict[int, ca.SX] = {value: arguments[a][e] for value, a, e in steps.loads}
    held |= {value: ca.SX(number) for value, number in steps.constants}
    for value, operation, left, right in steps.steps:
        if operation == ca.OP_SIGN:
            held[value] = jump(held[left])
        elif operation in UNARY or right == NOTHING:
            held[value] = ca.SX.unary(operation, held[left])
        else:
            held[value] = ca.SX.binary(operation, held[left], held[right])
    results = [ca.SX(size, 1) for size in steps.results]
    for output, entry, value in steps.stores:
        results[output][entry] = held[value]
    return [ca.densify(result) for result in results]
