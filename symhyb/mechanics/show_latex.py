r"""The equations of motion of a model in LaTeX: ``align*`` of amsmath, with x, ẋ and ẍ."""

import re
from collections.abc import Iterator

import sympy as sp
from sympy.printing.latex import LatexPrinter

from symhyb.mechanics.readable import Readable
from symhyb.mechanics.rows import Named, Row
from symhyb.mechanics.symbols import reading_symbol
from symhyb.mechanics.tabulated import MappedBase, TabulatedBase
from symhyb.mechanics.words import (
    curves_in_words,
    maps_in_words,
    rates_title,
    reading_in_words,
    sensor_notes,
)
from symhyb.model.types import Model


class _Latex(LatexPrinter):  # type: ignore[misc]
    """SymPy's LaTeX with the functions that forces may hold."""

    def _print_Heaviside(self, expression: sp.Heaviside, exp: str | None = None) -> str:
        return self._called("step", expression.args[:1], exp)

    def _print_AppliedUndef(self, expression: sp.Expr, exp: str | None = None) -> str:
        return self._called(expression.func.__name__, expression.args, exp)

    def _print_TabulatedBase(self, expression: TabulatedBase, exp: str | None = None) -> str:
        name, marks = expression.called
        inside = ", ".join(self._print(item) for item in expression.args)
        power = f"^{{{marks}{exp or ''}}}".replace("'", r"\prime ") if marks or exp else ""
        return rf"\mathrm{{curve}}{power}\left(\text{{{_escaped(name)}}}, {inside}\right)"

    def _print_MappedBase(self, expression: MappedBase, exp: str | None = None) -> str:
        name, by = expression.called
        inside = ", ".join(self._print(item) for item in expression.args)
        marks = (f"_{{{by}}}" if by else "") + (f"^{{{exp}}}" if exp else "")
        return rf"\mathrm{{map}}{marks}\left(\text{{{_escaped(name)}}}, {inside}\right)"

    def _called(self, name: str, arguments: tuple[sp.Expr, ...], exp: str | None) -> str:
        inside = ", ".join(self._print(item) for item in arguments)
        power = f"^{{{exp}}}" if exp else ""
        return rf"\mathrm{{{_escaped(name)}}}{power}\left({inside}\right)"


def as_latex(model: Model, derived: Readable) -> str:
    """Write derived equations, inner states, names, parameters and sensors of a model."""
    names = _symbol_names(derived)
    printer = _Latex({"symbol_names": names, "full_prec": False})
    matrices = any(len(row.of) == 2 for row in derived.rows)
    body = _matrices if matrices else _coordinates
    result = [_comment(model.title), *body(model, derived, printer)]
    inner = [
        rf"\dot{{{names[symbol]}}} &= {printer.doprint(rate)}" for symbol, rate in derived.inner
    ]
    sampled = [
        rf"{names[symbol]} &\leftarrow {printer.doprint(after)} && \text{{every {every:.10g} s}}"
        for symbol, after, every in derived.sampled
    ]
    held = [
        rf"0 &= {printer.doprint(held)} && \text{{{_escaped(row.label)}}}"
        for row in derived.gaps
        for held in (row.gap if row.slip is None else row.speed(derived.symbols),)
    ]
    tables = (*curves_in_words(model), *maps_in_words(model))
    result += [_comment(f"{said}: {words}") for said, words in tables]
    used = [f"{names[item.symbol]} &= {printer.doprint(item.value)}" for item in derived.names]
    for title, rows in (
        ("constraints, held by forces J^T lambda beside k_e, J the slopes by q", held),
        (rates_title(model), inner),
        ("sampled, and held in between", sampled),
        ("with", used),
        ("parameters", list(_parameters(model, derived, printer))),
        ("sensors", list(_sensors(model, derived, printer))),
    ):
        result += [_comment(title), *_aligned(rows)] if rows else []
    return "\n".join(result) + "\n"


def _coordinates(model: Model, derived: Readable, printer: _Latex) -> Iterator[str]:
    for i, coordinate in enumerate(model.coordinates):
        inertia, k_c, forces = (derived.of(side, i) for side in ("M", "k_c", "k_e"))
        nothing = (Row("M", (i,), "", sp.Integer(0)),)
        rows = [
            _row(printer, "+" if k else "", row.value, r"M \ddot{q}", row.source)
            for k, row in enumerate(inertia or nothing)
        ]
        rows += [_row(printer, "+", row.value, "k_c", row.source) for row in k_c]
        rows += [
            _row(printer, "+" if k else "=", row.value, "", row.source)
            for k, row in enumerate(forces or nothing)
        ]
        if coordinate.imposed:
            name = _escaped(coordinate.name)
            rows.append(rf"& {{}}+{{}} \mathrm{{reaction}}({name}) && \text{{imposed motion}}")
        yield _comment(f"{coordinate.name}: {coordinate.about}")
        yield from _aligned(rows)


def _matrices(model: Model, derived: Readable, printer: _Latex) -> Iterator[str]:
    """Entry by entry, which stays readable however large the matrix is."""
    names = [_latex_name(coordinate.name) for coordinate in model.coordinates]
    for side, about in (("M", "M, symmetric; entries not shown are 0"), ("k_c", ""), ("k_e", "")):
        letter, _, mark = side.partition("_")
        rows = []
        for row in derived.rows:
            if row.side == side:
                index = ",".join((*([mark] if mark else []), *(names[i] for i in row.of)))
                rows.append(f"{letter}_{{{index}}} &= {printer.doprint(row.value)}")
        if rows:
            yield _comment(about or side)
            yield from _aligned(rows)


def _parameters(model: Model, derived: Readable, printer: _Latex) -> Iterator[str]:
    for item, symbol in zip(model.all_parameters(), derived.symbols.p, strict=True):
        numbers = (item.value,) if item.sd is None else (item.value, item.sd)
        value = r" \pm ".join(printer.doprint(sp.Float(number)) for number in numbers)
        yield f"{printer.doprint(symbol)} &= {value}{_unit(item.unit.text)}"


def _sensors(model: Model, derived: Readable, printer: _Latex) -> Iterator[str]:
    for sensor, output in zip(model.sensors, derived.outputs, strict=True):
        (note,) = sensor_notes(sensor)
        beside = rf" && \text{{{_escaped(note)}}}" if note else ""
        yield rf"\text{{{_escaped(sensor.name)}}} &= {printer.doprint(output)}{beside}"
    held = [item.name for item in model.constraints]
    for reading in derived.readings:
        words = _escaped(reading_in_words(reading, held))
        yield rf"{printer.doprint(reading_symbol(reading))} &: \text{{{words}}}"


def _aligned(rows: list[str]) -> list[str]:
    inner = [rf"  {row} \\" for row in rows[:-1]]
    return [r"\begin{align*}", *inner, f"  {rows[-1]}", r"\end{align*}"]


def _row(printer: _Latex, joint: str, value: sp.Expr, side: str, source: str) -> str:
    """One summand behind = or +; the sign of a single negative term takes the place of the +."""
    written = printer.doprint(value)
    if joint == "+" and written.startswith("-"):
        if isinstance(value, sp.Add):
            written = rf"\left({written}\right)"
        else:
            joint, written = "-", printer.doprint(-value)
    begin = f"{{}}{joint}{{}} " if joint else ""
    origin = rf"\text{{{_escaped(source)}}}"
    return f"& {begin}{written} && " + (rf"{side},\ {origin}" if side else origin)


def _symbol_names(derived: Readable) -> dict[sp.Symbol, str]:
    s = derived.symbols
    names = {symbol: _latex_name(symbol.name) for symbol in (*s.q, *s.states, *s.u, *s.p, s.t)}
    for q, v, a in zip(s.q, s.v, s.a, strict=True):
        stem, mark, index = names[q].partition("_")
        names[v] = rf"\dot{{{stem}}}{mark}{index}"
        names[a] = rf"\ddot{{{stem}}}{mark}{index}"
    names |= {
        z: rf"{z.name.partition('(')[0]}_{{\text{{{_escaped(name)}}}}}"
        for name, states in s.z.items()
        for z in states
    }
    names |= {item.symbol: _name_of(item) for item in derived.names}
    for reading in derived.readings:
        inside = ", ".join(rf"\text{{{_escaped(name)}}}" for name in reading.names)
        names[reading_symbol(reading)] = rf"\mathrm{{{_escaped(reading.what)}}}({inside})"
    return names


def _name_of(item: Named) -> str:
    """|b − a|, its time derivative, the speed of a point, a derivative, or what recurs."""
    owners = [rf"\text{{{_escaped(name)}}}" for name in item.owners]
    match item.kind:
        case "distance":
            return rf"\left| {owners[1]} - {owners[0]} \right|"
        case "lapse":
            return rf"\frac{{d}}{{dt}} \left| {owners[1]} - {owners[0]} \right|"
        case "speed":
            return rf"\left| v_{{{owners[0]}}} \right|"
        case "part":
            return _latex_name(item.symbol.name)
    if item.kind.startswith("turn"):
        return _turn_name(item, owners[1])
    axis = _AXES[item.owners[0]]
    if item.kind == "slope":
        by = _latex_name(item.owners[2])
        return rf"\frac{{\partial {axis}_{{{owners[1]}}}}}{{\partial {by}}}"
    side = "M" if item.kind == "pull" else "c"
    return rf"\ddot{{{axis}}}_{{{side},{owners[1]}}}"


def _turn_name(item: Named, body: str) -> str:
    """A component of the angular velocity of a body in space, or a derivative of it."""
    turn = rf"\omega^{item.owners[0]}_{{{body}}}"
    match item.kind:
        case "turn slope":
            return rf"\frac{{\partial {turn}}}{{\partial \dot{{{_latex_name(item.owners[2])}}}}}"
        case "turn pull" | "turn bias":
            side = "M" if item.kind == "turn pull" else "c"
            return rf"\dot{{\omega}}^{item.owners[0]}_{{{side},{body}}}"
    return turn


_AXES = {"z": "z", "n": "n", "x": "x", "y": "y", "s": "s", "angle": r"\varphi"}


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


_SPECIAL = {
    "_": r"\_",
    "%": r"\%",
    "&": r"\&",
    "#": r"\#",
    "$": r"\$",
    "{": r"\{",
    "}": r"\}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "\\": r"\textbackslash{}",
}


def _escaped(text: str) -> str:
    """A name, or what the file says about something, inside \\text."""
    return "".join(_SPECIAL.get(letter, letter) for letter in " ".join(text.split()))


def _comment(text: str) -> str:
    return "% " + " ".join(text.split())
