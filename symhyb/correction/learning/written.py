"""Chosen terms as elements of the model file: a listed kind where a term is that law, else a law.

    ΔF_x = … − 120 x³ − 0.8 |x'| x' + 0.3 x y'
             spring    drag           law

A term of rates acts in a file as the force M Δv', for a file holds forces; this is exact where the
mass matrix M can be written down. Values of :class:`Chosen` carry the sign of ΔF or Δv'; passive
kinds of the vocabulary resist, so that their keys carry the other one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from symhyb.correction.learning.corrected import Formulation
from symhyb.correction.learning.library import Candidate
from symhyb.model.expression import Name, parse_expression, unit_of
from symhyb.model.types import Element, Model, On, Parameter
from symhyb.model.vocabulary import KINDS, force_unit, key_unit, stretch_unit
from symhyb.units import ONE, Unit, parse_unit

LETTERS = {"stiffness": "k", "quadratic": "k_2", "cubic": "k_3", "damping": "d", "drag": "b"}
LETTERS |= {"coulomb": "F_c", "transition": "v_t", "constant": "F_0"}
PREFIX = "learned"


@dataclass(frozen=True, slots=True)
class Chosen:
    """A term that acts on coordinate ``on``: ``value`` and ``sd`` (None: not known) of its
    coefficient, SI, and the value that the optimiser ``regressed``."""

    on: str
    term: Candidate
    value: float
    sd: float | None
    regressed: float

    @property
    def listed(self) -> bool:
        """Whether it is a law of the vocabulary, which may only lose energy where it resists."""
        own = self.term.kind != "law" and self.term.of == self.on
        return own and (KINDS[self.term.kind].energy != "dissipative" or self.value < 0)

    @property
    def sign(self) -> int:
        """What its coefficient is multiplied by to give the key of the element."""
        return -1 if self.listed and KINDS[self.term.kind].passive else 1


@dataclass(frozen=True, slots=True)
class Written:
    """Terms as ``elements``; ``paths`` has for each term its element and the paths of the
    parameters that hold its coefficient, more than one where rates of one coordinate make forces on
    several."""

    elements: tuple[Element, ...]
    paths: tuple[tuple[str, tuple[str, ...]], ...]

    def provided(self, found: tuple[tuple[str, object], ...]) -> tuple[Element, ...]:
        """The elements with where they come from."""
        return tuple(replace(element, found=found) for element in self.elements)


def term_unit(model: Model, on: str, text: str, formulation: Formulation) -> Unit:
    """The unit of the coefficient of a term, whose steps are dimensionless."""
    units = {c.name: stretch_unit(model, On(c.name)) for c in model.coordinates}
    if formulation == "force":
        whole = force_unit(model, On(on))
    else:
        whole = units[on] / parse_unit("s") ** 2
    if "tanh" in text or text == "1":
        return whole

    def of_name(name: Name) -> Unit:
        return units[name.name] / parse_unit("s") ** name.order

    found = unit_of(parse_expression(text), of_name)
    return whole if found is None else whole / found


def as_forces(model: Model, chosen: Sequence[Chosen]) -> Written:
    """Terms of ΔF as elements; springs on one coordinate join."""
    groups: dict[tuple[str, object], list[int]] = {}
    for i, one in enumerate(chosen):
        joins = one.listed and one.term.kind == "spring"
        groups.setdefault((one.on, "spring" if joins else i), []).append(i)
    taken = {element.name for element in model.elements}
    elements: list[Element] = []
    paths: dict[int, tuple[str, tuple[str, ...]]] = {}
    for (on, _), rows in groups.items():
        first = chosen[rows[0]]
        name = _free_name(taken, first.term.kind if first.listed else "law", on, model)
        parts = [chosen[i] for i in rows]
        made, symbols = (_listed if first.listed else _law)(model, name, parts)
        elements.append(made)
        paths |= {i: (name, (f"{name}.{symbol}",)) for i, symbol in zip(rows, symbols, strict=True)}
    return Written(tuple(elements), tuple(paths[i] for i in range(len(chosen))))


def as_rates(
    model: Model, chosen: Sequence[Chosen], mass: Mapping[tuple[str, str], str]
) -> Written:
    """Terms of Δv' as one law a coordinate, with the entries of the mass ``matrix`` that are not
    zero as expressions by the names of two coordinates."""
    taken = {element.name for element in model.elements}
    rows = [c.name for c in model.coordinates]
    elements = []
    paths: dict[int, tuple[str, tuple[str, ...]]] = {}
    for row in rows:
        acting = [i for i, one in enumerate(chosen) if (row, one.on) in mass]
        if not acting:
            continue
        name, own, texts = _free_name(taken, "rates", row, model), [], []
        for i in acting:
            one = chosen[i]
            symbol = _symbol(model, f"r_{i + 1}")
            text, width = _with_width(model, name, one, f"v_{i + 1}")
            own += [_parameter(model, name, symbol, one, "rates"), *width]
            texts.append(f"({mass[row, one.on]})*{symbol}*{text}")
            paths.setdefault(i, (name, ()))
            paths[i] = (paths[i][0], (*paths[i][1], f"{name}.{symbol}"))
        elements.append(_as_law(model, name, row, " + ".join(texts), own, "learned rates"))
    return Written(tuple(elements), tuple(paths[i] for i in range(len(chosen))))


def _listed(model: Model, name: str, parts: Sequence[Chosen]) -> tuple[Element, list[str]]:
    kind, place = parts[0].term.kind, On(parts[0].on)
    own, entries, symbols = [], [], []
    for one in parts:
        key = one.term.key
        unit, symbol = key_unit(model, kind, key, place), _symbol(model, LETTERS[key])
        sd = None if one.sd is None else one.sd / unit.factor
        value = one.sign * one.value / unit.factor
        own.append(Parameter(symbol, value, unit, sd, one.term.words, owner=name))
        entries.append((key, parse_expression(symbol)))
        symbols.append(symbol)
    if parts[0].term.width:
        unit, symbol = key_unit(model, kind, "transition", place), _symbol(model, "v_t")
        own.append(Parameter(symbol, parts[0].term.width / unit.factor, unit, owner=name))
        entries.append(("transition", parse_expression(symbol)))
    return Element(name, kind, place, tuple(entries), tuple(own)), symbols


def _law(model: Model, name: str, parts: Sequence[Chosen]) -> tuple[Element, list[str]]:
    one, symbol = parts[0], _symbol(model, "c")
    text, width = _with_width(model, name, one, "v_t")
    own = [_parameter(model, name, symbol, one, "force"), *width]
    return _as_law(model, name, one.on, f"{symbol}*{text}", own, one.term.words), [symbol]


def _as_law(
    model: Model, name: str, on: str, text: str, own: Sequence[Parameter], about: str
) -> Element:
    key = "torque" if force_unit(model, On(on)).text == "N*m" else "force"
    entries = ((key, parse_expression(text)),)
    return Element(name, "law", On(on), entries, tuple(own), about=f"{about}: no law by name")


def _with_width(
    model: Model, name: str, one: Chosen, letter: str
) -> tuple[str, tuple[Parameter, ...]]:
    """The term with the speed of its step as a parameter."""
    if not one.term.width:
        return one.term.text, ()
    unit = stretch_unit(model, On(one.term.of)) / parse_unit("s")
    symbol = _symbol(model, letter)
    width = Parameter(symbol, one.term.width / unit.factor, unit, owner=name)
    return one.term.template.format(w=symbol), (width,)


def _parameter(
    model: Model, name: str, symbol: str, one: Chosen, formulation: Formulation
) -> Parameter:
    unit = term_unit(model, one.on, one.term.text, formulation) or ONE
    sd = None if one.sd is None else one.sd / unit.factor
    about = (
        one.term.words if formulation == "force" else f"acceleration of {one.on} by {one.term.text}"
    )
    return Parameter(symbol, one.value / unit.factor, unit, sd, about, owner=name)


def _free_name(taken: set[str], kind: str, on: str, model: Model) -> str:
    """A name that no element has; it is taken from then on."""
    base = f"{PREFIX}_{kind}"
    base += f"_{on}" if sum(not c.imposed for c in model.coordinates) > 1 else ""
    name, count = base, 2
    while name in taken:
        name, count = f"{base}_{count}", count + 1
    taken.add(name)
    return name


def _symbol(model: Model, letter: str) -> str:
    """A name that hides none of the model."""
    taken = {c.name for c in model.coordinates} | {u.name for u in model.inputs}
    taken |= {p.name for p in model.parameters if not p.owner} | {"t"}
    while letter in taken:
        letter += "_"
    return letter
