"""A recording looked at: by itself, or as a model takes it, with the first checks against that."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from symhyb.data.files.formats import read_table
from symhyb.data.known_table import table_of_known, values_in
from symhyb.data.look import Look, look_at
from symhyb.data.recording import Recording, read_recording
from symhyb.data.rows import Span
from symhyb.data.whole_file import whole_file
from symhyb.errors import InputError, Problem
from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.steps import Say
from symhyb.writing import require_new, write_file

if TYPE_CHECKING:  # without a model the numerics are not needed
    from symhyb.discrepancy.checks.first_checks import FirstChecks

PICTURES = (".png", ".svg")


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What is in a recording, sentences on columns that are no signals (``left``), and the first
    checks against a model, None without one."""

    look: Look
    left: tuple[str, ...] = ()
    checks: "FirstChecks | None" = None


def look_into(
    path: Path,
    model: Path | None,
    columns: Mapping[str, str],
    span: Span,
    say: Say,
    known: Path | None = None,
) -> Seen:
    """Look at a recording, with the model file that it belongs to if one is given, and the table of
    what is ``known`` of its parameters.

    Raises:
        InputError: the recording, the map or the model is wrong.
    """
    say("reading the recording")
    if model is None:
        if known is not None:
            text = "known values are of parameters of a model; give the model, too"
            raise InputError(Problem(text, file=str(known)))
        whole = whole_file(read_table(path), columns, span)
        return Seen(look_at(whole.recording, whole.units), whole.left)
    declared = read_model(model)
    table = table_of_known(known, declared)
    values = values_in(table, path)
    recording = read_recording(path, declared, columns, span=span, parameters=values)
    return Seen(_in_units(recording, declared), (), _checks(recording, declared, say))


def require_picture(path: Path, force: bool) -> None:
    """Refuse a file that no picture can be written to.

    Raises:
        InputError: its name ends otherwise, it is there already, or it cannot be written.
    """
    if path.suffix.lower() not in PICTURES:
        text = f"'{path.suffix}' is no picture that is drawn; end the name in .svg or .png"
        raise InputError(Problem(text, file=str(path)))
    require_new(path, force)


def write_picture(look: Look, path: Path) -> None:
    """Draw all channels over time.

    Raises:
        InputError: the file cannot be written.
    """
    from symhyb.report.looking import look_figure

    write_file(path, look_figure(look, path.suffix))


def _in_units(recording: Recording, model: Model) -> Look:
    """What is in a recording, in the units of the model instead of SI."""
    units = {one.name: one.unit for one in model.coordinates}
    units |= {one.name: one.unit for one in model.inputs}
    units |= {one.name: one.unit for one in model.sensors}
    inputs, sensors = (
        {name: values / units[name].factor for name, values in channels.items()}
        for channels in (recording.inputs, recording.sensors)
    )
    shown = Recording(
        recording.name, recording.t, inputs, sensors, recording.notes, recording.sha256
    )
    return look_at(shown, {name: unit.text for name, unit in units.items()})


def _checks(recording: Recording, model: Model, say: Say) -> "FirstChecks | None":
    """The first checks of a recording; none where no sensor changes."""
    from symhyb.data.cleaning import still
    from symhyb.discrepancy.checks.first_checks import first_checks
    from symhyb.numeric.lowered.machine import build

    if still([recording]) or model.engine is not None:  # it states no energies
        return None
    say("first checks")
    return first_checks(build(model), recording)
