r"""The equations of motion of a model, written for people.

    M(q,t) q'' + k_c(q,q',t) = k_e(q,q',u,t)        one block a coordinate, one row a cause

Here SymPy differentiates what :mod:`symhyb.numeric.machine` leaves to CasADi. Nothing is
simplified at large: small entries are tidied by a few exact rewritings, and the force of an
element on a coordinate stays as the element says it. The rows on one side add up.
"""

import re
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from math import prod

import sympy as sp
from sympy.printing.latex import LatexPrinter
from sympy.printing.str import StrPrinter
from sympy.simplify.fu import TR6, TR10i

from symhyb.mechanics.equations import Equations, derive
from symhyb.mechanics.kinematics import position
from symhyb.mechanics.symbols import to_sympy
from symhyb.model.types import Between, Model, On

MOST_TERMS = 300  # of a product that is multiplied out; beyond, an entry stays as derived
WIDTH = 100  # columns of text

_Row = tuple[str, sp.Expr]
"""Where a summand comes from, as a dotted name in the model file, and what it is."""


@dataclass(frozen=True, slots=True)
class _Line:
    """The equation of one coordinate: inertia + k_c = the sum of ``forces``."""

    inertia: sp.Expr
    k_c: sp.Expr
    forces: tuple[_Row, ...]


@dataclass(frozen=True, slots=True)
class _Distance:
    """The distance of two points, which forces call by its ``symbol`` |b − a|."""

    ends: tuple[str, str]
    symbol: sp.Symbol
    value: sp.Expr


def show_equations(model: Model, latex: bool = False) -> str:
    """Write M q'' + k_c = k_e coordinate by coordinate, each force with the element it comes from.

    Text in the notation of the model file, or LaTeX (``align*`` of amsmath) with x, ẋ and ẍ. Below
    stand the distances between points that the forces use, and the parameters in their own units.
    """
    equations = derive(model)
    distances = _distances(model, equations)
    lines = _lines(model, equations, distances)
    write = _as_latex if latex else _as_text
    return write(model, equations, lines, distances)


def _lines(model: Model, equations: Equations, distances: tuple[_Distance, ...]) -> Iterator[_Line]:
    """p = ∂T/∂v, M = ∂p/∂v, k_c = (∂p/∂q) v + ∂p/∂t − ∂T/∂q, k_e = Σ Q − ∂V/∂q."""
    s, kinetic = equations.symbols, equations.kinetic
    declared = sp.Integer(0)
    if model.energy.potential is not None:
        declared = to_sympy(model.energy.potential, s.scope)
    potentials = (("gravity", equations.potential - declared), ("energy.potential", declared))
    # SymPy may hold a distance d = √x in any power of x
    short = {d.value**power: d.symbol**power for d in distances for power in (1, 2, -1, -2, -3)}
    for i, (q, v) in enumerate(zip(s.q, s.v, strict=True)):
        p = sp.diff(kinetic, v)
        inertia = [_tidied(sp.diff(p, w)) * a for w, a in zip(s.v, s.a, strict=True)]
        k_c = [sp.diff(p, x) * w for x, w in zip(s.q, s.v, strict=True)]
        k_c += [sp.diff(p, s.t), -sp.diff(kinetic, q)]
        forces = [(name, _tidied(-sp.diff(energy, q))) for name, energy in potentials]
        for element, term in zip(model.elements, equations.terms, strict=True):
            force = term.forces[i].xreplace(short)
            plain = isinstance(element.place, On)  # nothing but the law of the element
            forces.append((f"elements.{element.name}", force if plain else _tidied(force)))
        acting = tuple(row for row in forces if row[1] != 0)
        yield _Line(sp.Add(*inertia), _tidied(sp.Add(*k_c)), acting)


def _tidied(expression: sp.Expr) -> sp.Expr:
    """The shortest of a few cheap forms: sin² + cos² = 1 and sums of angles, common factors out."""
    if max(map(_terms, sp.preorder_traversal(expression))) > MOST_TERMS:
        return expression
    flat = sp.expand_mul(expression)
    squares = sp.expand_mul(TR6(flat))  # cos² as 1 − sin²
    forms = (expression, flat, squares, TR10i(flat), TR10i(squares))
    return min(map(sp.factor_terms, forms), key=sp.count_ops)


def _terms(expression: sp.Basic) -> int:
    """How many terms it would have when multiplied out: a short product may hide millions."""
    if isinstance(expression, sp.Add):
        return sum(map(_terms, expression.args))
    if isinstance(expression, sp.Mul):
        return prod(map(_terms, expression.args))
    return 1


def _distances(model: Model, equations: Equations) -> tuple[_Distance, ...]:
    """The distances that elements use, each once; along one line they need no shorthand."""
    found = {}
    for element in model.elements:
        if isinstance(element.place, Between):
            a, b = ends = element.place.first, element.place.second
            (ax, ay), (bx, by) = (position(model, end, equations.symbols) for end in ends)
            value = sp.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
            if isinstance(value, sp.Pow):
                symbol = sp.Symbol(f"|{b} - {a}|", positive=True)
                found[value] = _Distance(ends, symbol, value)
    return tuple(found.values())


class _Text(StrPrinter):  # type: ignore[misc]
    """SymPy's text in the notation of the model file: ``abs``, ``min`` and ``max``."""

    def _print_Abs(self, expression: sp.Abs) -> str:
        return f"abs({self.stringify(expression.args, ', ')})"

    def _print_Max(self, expression: sp.Max) -> str:
        return f"max({self.stringify(expression.args, ', ')})"

    def _print_Min(self, expression: sp.Min) -> str:
        return f"min({self.stringify(expression.args, ', ')})"


def _as_text(
    model: Model, equations: Equations, lines: Iterator[_Line], distances: tuple[_Distance, ...]
) -> str:
    text = _Text({"full_prec": False}).doprint
    width = max((len(f"elements.{term.element}") for term in equations.terms), default=7)
    result = [model.title, "", "M(q,t) q'' + k_c(q,q',t) = k_e(q,q',u,t)"]
    for coordinate, line in zip(model.coordinates, lines, strict=True):
        about = f", {coordinate.about}" if coordinate.about else ""
        result += ["", f"{coordinate.name} [{coordinate.unit}]{about}"]
        rows = [("M q''", "", line.inertia), ("+ k_c", "", line.k_c)]
        rows += [("", name, value) for name, value in line.forces or (("", sp.Integer(0)),)]
        rows[2] = ("= k_e", *rows[2][1:])
        for side, name, value in rows:
            result += _wrapped(f"  {side:<5}  {name:<{width}}  ", text(value))
    if distances:
        result += ["", "distances, m"]
    for item in distances:
        result += _wrapped(f"  {item.symbol} = ", text(item.value))
    return "\n".join(row.rstrip() for row in (*result, *_parameters(model))) + "\n"


def _wrapped(label: str, text: str) -> list[str]:
    """Break a long expression between its summands, below where it began."""
    return textwrap.wrap(
        text, max(WIDTH, len(label) + 40), initial_indent=label, break_on_hyphens=False,
        subsequent_indent=" " * len(label), break_long_words=False,
    )  # fmt: skip


def _parameters(model: Model) -> Iterator[str]:
    """Path, value with standard deviation, unit and meaning in columns."""
    table = [
        (
            item.path,
            f"{item.value:.10g}" + ("" if item.sd is None else f" ± {item.sd:.3g}"),
            "" if item.unit.text == "1" else item.unit.text,
            item.about,
        )
        for item in model.all_parameters()
    ]
    if table:
        yield from ("", "parameters")
    widths = [max((len(row[i]) for row in table), default=0) for i in range(3)]
    for *cells, about in table:
        row = (f"{cell:<{width}}" for cell, width in zip(cells, widths, strict=True))
        yield "  " + "  ".join((*row, about))


def _as_latex(
    model: Model, equations: Equations, lines: Iterator[_Line], distances: tuple[_Distance, ...]
) -> str:
    names = _latex_names(equations, distances)
    printer = LatexPrinter({"symbol_names": names, "full_prec": False})
    result = [_comment(model.title)]
    for coordinate, line in zip(model.coordinates, lines, strict=True):
        rows = [("", line.inertia, r"M \ddot{q}")]
        if line.k_c != 0:
            rows.append(("+", line.k_c, "k_c"))
        rows += [
            ("+" if i else "=", value, rf"\text{{{_escaped(name)}}}")
            for i, (name, value) in enumerate(line.forces or (("", sp.Integer(0)),))
        ]
        result.append(_comment(f"{coordinate.name}: {coordinate.about}"))
        result += _aligned([_row(printer, *row) for row in rows])
    notes = [(names[item.symbol], printer.doprint(item.value)) for item in distances]
    for item, symbol in zip(model.all_parameters(), equations.symbols.p, strict=True):
        numbers = (item.value,) if item.sd is None else (item.value, item.sd)
        value = r" \pm ".join(printer.doprint(sp.Float(number)) for number in numbers)
        notes.append((names[symbol], value + _unit(item.unit.text)))
    if notes:
        result.append("% distances and parameters")
        result += _aligned([f"{name} &= {value}" for name, value in notes])
    return "\n".join(result) + "\n"


def _aligned(rows: list[str]) -> list[str]:
    inner = [rf"  {row} \\" for row in rows[:-1]]
    return [r"\begin{align*}", *inner, f"  {rows[-1]}", r"\end{align*}"]


def _row(printer: LatexPrinter, joint: str, value: sp.Expr, source: str) -> str:
    """One summand behind = or +; the sign of a single negative term takes the place of the +."""
    written = printer.doprint(value)
    if joint == "+" and written.startswith("-"):
        if isinstance(value, sp.Add):
            written = rf"\left({written}\right)"
        else:
            joint, written = "-", printer.doprint(-value)
    begin = f"{{}}{joint}{{}} " if joint else ""
    return f"& {begin}{written} && {source}"


def _latex_names(equations: Equations, distances: tuple[_Distance, ...]) -> dict[sp.Symbol, str]:
    s = equations.symbols
    names = {symbol: _latex_name(symbol.name) for symbol in (*s.q, *s.u, *s.p, s.t)}
    for q, v, a in zip(s.q, s.v, s.a, strict=True):
        stem, mark, index = names[q].partition("_")
        names[v] = rf"\dot{{{stem}}}{mark}{index}"
        names[a] = rf"\ddot{{{stem}}}{mark}{index}"
    for item in distances:
        a, b = map(_escaped, item.ends)
        names[item.symbol] = rf"\left\lvert \mathrm{{{b}}} - \mathrm{{{a}}} \right\rvert"
    return names


def _latex_name(path: str) -> str:
    """Greek letters and indices as LaTeX; the owner of a parameter becomes an index."""
    owner, _, name = path.rpartition(".")
    stem, mark, index = sp.latex(sp.Symbol(name)).partition("_")
    if re.fullmatch("[A-Za-z]{2,}", stem):
        stem = rf"\mathit{{{stem}}}"
    written = f"{stem}{mark}{index}"
    return rf"{{{written}}}_{{\text{{{_escaped(owner)}}}}}" if owner else written


def _unit(text: str) -> str:
    if text == "1":
        return ""
    powers = re.sub(r"\^(\([^)]*\)|-?\d+)", r"^{\1}", text)
    return rf"\ \mathrm{{{powers}}}".replace("*", r"\,")


def _escaped(name: str) -> str:
    return name.replace("_", r"\_")


def _comment(text: str) -> str:
    return "% " + " ".join(text.split())
