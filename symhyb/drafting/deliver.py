"""Carry out an order: a first model file, checked as any other, then written."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from symhyb.data.files.formats import read_table
from symhyb.data.files.table import Column, Table
from symhyb.drafting.columns import Role, as_input, as_sensor, guessed_roles, unit_in
from symhyb.drafting.templates import line_text, read_coordinates, template_text
from symhyb.drafting.written import (
    Number,
    map_options,
    parameters_of,
    with_columns,
    with_numbers,
    with_title,
    without_zeros,
)
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.writing import write_file

UNUSED = ("-", "none", "")


@dataclass(frozen=True, slots=True)
class Order:
    """What is wanted: a ``template`` or ``coordinates`` ("x [m]"), a ``title`` (empty: that of the
    template), ``numbers`` by parameter, and what columns of a recording are ("acc=x''",
    "u=input f", "temp=-")."""

    template: str = ""
    coordinates: tuple[str, ...] = ()
    title: str = ""
    numbers: tuple[tuple[str, Number], ...] = ()
    columns: tuple[str, ...] = ()
    recording: Path | None = None


@dataclass(frozen=True, slots=True)
class Drafted:
    """A checked ``model``, whose text is the file, how many ``guesses`` it holds, and the options
    (``maps``) that read the recording with it."""

    model: Model
    guesses: int
    maps: tuple[str, ...]


Confirm = Callable[[Table, Model, tuple[Role, ...]], tuple[Role, ...]]


def start_text(order: Order) -> str:
    """The text to begin with: a template or a line of bodies.

    Raises:
        InputError: neither or both are wanted, or one that does not exist.
    """
    if order.template and order.coordinates:
        raise InputError(Problem("give a template or coordinates, not both"))
    if order.coordinates:
        return line_text(read_coordinates(order.coordinates))
    if not order.template:
        text = "say what to begin with: --template NAME (symhyb new --list) or --coordinate 'x [m]'"
        raise InputError(Problem(text))
    return template_text(order.template)


def drafted(order: Order, confirm: Confirm | None = None, file: str = "") -> Drafted:
    """The model that is wanted; ``confirm`` is asked what the columns of the recording are.

    Raises:
        InputError: every problem of the order, or of the model that it makes.
    """
    text = start_text(order)
    if order.title:
        text = with_title(text, order.title)
    numbers = dict(order.numbers)
    text = with_numbers(text, numbers)
    if order.coordinates:
        text = without_zeros(text, numbers)
    roles: tuple[Role, ...] = ()
    if order.recording is not None:
        table, plain = read_table(order.recording), parse_model(text)
        roles = _stated(guessed_roles(table, plain), order.columns, table, plain)
        roles = confirm(table, plain, roles) if confirm is not None else roles
        if not any(role.kind == "sensor" for role in roles):
            said = "no column is a sensor; say what one measures, as in --column \"NAME=x''\""
            raise InputError(Problem(said, file=str(order.recording)))
        text = with_columns(text, roles, order.recording.name)
    elif order.columns:
        raise InputError(
            Problem("--column needs the recording that it is a column of: --from FILE")
        )
    model = parse_model(text, file)
    build(model)
    guesses = sum(1 for name in parameters_of(start_text(order)) if name not in (*numbers, "g"))
    guesses += sum(bool(role.guessed) for role in roles if role.kind != "none")
    return Drafted(model, guesses, tuple(map_options(roles)))


def write_draft(done: Drafted, target: Path) -> None:
    """Write the file, whole or not at all.

    Raises:
        InputError: it cannot be written.
    """
    write_file(target, done.model.text)


def _stated(
    roles: tuple[Role, ...], options: Sequence[str], table: Table, model: Model
) -> tuple[Role, ...]:
    """The roles with what options say of columns."""
    found, problems = list(roles), list[Problem]()
    for text in options:
        name, equals, said = text.partition("=")
        at = next((i for i, r in enumerate(found) if name.strip() in _names(r, table)), None)
        if not equals or at is None:
            known = [column_of(role, table).name for role in found]
            hint = did_you_mean(name.strip(), known)
            what = f"there is no column '{name.strip()}'{hint}" if equals else "write COLUMN=WHAT"
            problems.append(Problem(what, f"--column {text}"))
            continue
        try:
            others = [*found[:at], *found[at + 1 :]]
            found[at] = role_from(said, column_of(found[at], table), model, others)
        except InputError as error:
            problems += [replace(one, place=f"--column {text}") for one in error.problems]
    if problems:
        raise InputError(problems)
    return tuple(found)


def _names(role: Role, table: Table) -> tuple[str, str]:
    return role.column, column_of(role, table).name


def column_of(role: Role, table: Table) -> Column:
    """The column that has a role."""
    return next(column for column in table.columns if column.header == role.column)


def role_from(said: str, column: Column, model: Model, taken: Sequence[Role]) -> Role:
    """What a person says that a column is: ``x''``, ``x [mm]``, ``input f``, or ``-`` for nothing.

    Raises:
        InputError: an input that the model does not have.
    """
    said = said.strip()
    if said in UNUSED:
        return Role(column.header, "none", guessed="left out")
    if said.startswith("input"):
        name, known = said.removeprefix("input").strip(), [item.name for item in model.inputs]
        if name not in known:
            raise InputError(Problem(f"there is no input '{name}'{did_you_mean(name, known)}"))
        return replace(as_input(column, name, model), guessed="")
    measures, _, unit = said.partition("[")
    header = unit_in(column)
    text = unit.strip().rstrip("]").strip() or (header.text if header is not None else "")
    why = "" if text else "its unit"
    text = text or _usual_unit(measures.strip(), model)
    return replace(as_sensor(column, measures.strip(), text, model, taken), guessed=why)


def _usual_unit(measures: str, model: Model) -> str:
    """The unit of an expression of one coordinate or its rates in the model; else m."""
    order = len(measures) - len(measures.rstrip("'"))
    for coordinate in model.coordinates:
        if coordinate.name == measures.rstrip("'"):
            return coordinate.unit.text + ("", "/s", "/s^2")[min(order, 2)]
    return "m"
