"""Questions that a new model file is made from, asked one at a time; an empty answer takes the
guess in brackets."""

from dataclasses import replace
from pathlib import Path

import typer

from symhyb.data.files.formats import read_table
from symhyb.data.files.table import Table
from symhyb.drafting.columns import Role, unit_in
from symhyb.drafting.deliver import Order, column_of, role_from, start_text
from symhyb.drafting.templates import TEMPLATES, read_coordinates, summary
from symhyb.drafting.written import Number, parameters_of, read_numbers
from symhyb.errors import InputError
from symhyb.model.expression import ExpressionError, parse_expression
from symhyb.model.types import Model

LINE = "line"  # bodies in a line, from coordinates


def asked(order: Order) -> Order:
    """The order with what was not said yet: where to begin, a recording, and numbers."""
    if not order.template and not order.coordinates:
        order = _beginning(order)
    if not order.title:
        order = replace(order, title=_line("Title, empty for that of the template"))
    if order.recording is None:
        order = _recording(order)
    given = dict(order.numbers)
    missing = {k: v for k, v in parameters_of(start_text(order)).items() if k not in given}
    if missing:
        typer.echo("Numbers, as 12.5 or 12.5 ± 0.3; empty leaves a guess, which the file says.")
    for name, (value, sd, unit, about) in missing.items():
        number = _number(name, f"{about}: {name} [{unit}]", value, sd)
        if number is not None:
            given[name] = number
    return replace(order, numbers=tuple(given.items()))


def confirmed(table: Table, model: Model, roles: tuple[Role, ...]) -> tuple[Role, ...]:
    """What each column is, after a look at the guess."""
    typer.echo(
        "Columns of the recording. Answer with what a sensor measures (x, x', x'', x - y), 'input"
        " NAME', or '-' to leave it out; empty takes the guess."
    )
    found = list(roles)
    for i, role in enumerate(roles):
        column = column_of(role, table)
        guess = {"input": f"input {role.name}", "none": "-"}.get(role.kind, role.measures)
        while True:
            said = _line(f"{role.column}, {_range(table, role)}: is", guess) or guess
            try:
                others = [*found[:i], *found[i + 1 :]]
                found[i] = _with_unit(said, role_from(said, column, model, others), table, model)
                break
            except (InputError, ExpressionError) as error:
                typer.echo(f"  {error}")
    return tuple(found)


def _with_unit(said: str, role: Role, table: Table, model: Model) -> Role:
    """A sensor with its unit, which is asked for where the header states none."""
    if role.kind != "sensor":
        return role
    parse_expression(role.measures)
    if "[" in said or unit_in(column_of(role, table)) is not None:
        return role
    unit = _line(f"  unit of {role.column}", role.unit) or role.unit
    return replace(role, unit=unit, guessed="")


def _beginning(order: Order) -> Order:
    typer.echo("Begin with one of these, or with bodies in a line, one a coordinate:")
    for name in TEMPLATES:
        typer.echo(f"  {name:<12} {summary(name)}")
    typer.echo(f"  {LINE:<12} Bodies in a line, with springs and dampers.")
    while True:
        name = _line("Begin with", TEMPLATES[0]) or TEMPLATES[0]
        if name in TEMPLATES:
            return replace(order, template=name)
        if name == LINE:
            return replace(order, coordinates=_coordinates())
        typer.echo(f"  there is no '{name}'")


def _coordinates() -> tuple[str, ...]:
    """Coordinates as ``x [m]``, until an empty answer."""
    found: list[str] = []
    while True:
        said = _line("Coordinate, as x [m] or phi [rad]" + ", empty to end" * bool(found))
        if not said and found:
            return tuple(found)
        try:
            read_coordinates([*found, said])
            found.append(said)
        except InputError as error:
            typer.echo(f"  {error}")


def _recording(order: Order) -> Order:
    while True:
        said = _line("Recording whose columns become sensors, empty for none")
        if not said:
            return order
        try:
            read_table(said)
            return replace(order, recording=Path(said))
        except InputError as error:
            typer.echo(f"  {error}")


def _number(name: str, question: str, value: float, sd: float | None) -> Number | None:
    guess = f"{value:g}" + ("" if sd is None else f" ± {sd:g}")
    while True:
        said = _line(question, guess)
        if not said:
            return None
        try:
            return read_numbers([f"{name}={said}"])[name]
        except InputError as error:
            typer.echo(f"  {error.problems[0].text}")


def _line(question: str, guess: str = "") -> str:
    """An answer without blanks around it; empty where the guess is taken."""
    shown = f"{question} [{guess}]" if guess else question
    answer = typer.prompt(shown, default="", show_default=False)
    return str(answer).strip()


def _range(table: Table, role: Role) -> str:
    import numpy as np

    values = column_of(role, table).values
    known = values[np.isfinite(values)]
    return f"{known.min():.4g} … {known.max():.4g}" if known.size else "no number"
