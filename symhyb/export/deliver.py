"""An export as files: which ones, where, and what to say about them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from symhyb.errors import InputError, Problem
from symhyb.export.adams import adams_files
from symhyb.export.c_code import c_files
from symhyb.export.curve_table import curve_tables
from symhyb.export.fmu import fmu, kinds_of
from symhyb.export.functions.exported import serialised
from symhyb.export.simulink import simulink_files
from symhyb.export.spec import C_WORDS, Role, Spec, require_c_names, spec_of
from symhyb.model.types import Model
from symhyb.writing import require_folder, staged, write_file

TARGETS = ("fmu", "c", "casadi", "adams", "simulink", "curve", "latex", "urdf", "mjcf", "monitor")
ROBOTS = ("urdf", "mjcf")
FOLDERS = ("c", "adams", "simulink", "curve", "monitor")  # what consists of several files


@dataclass(frozen=True, slots=True)
class Order:
    """What a person asks for: ``elements`` alone (none: those found) or the ``whole`` model;
    ``kinds`` None for those that are usual; ``robot`` is the URDF or MJCF that is to be changed;
    ``spans`` are the ranges of stretch and rate of a table, SI; ``recording`` is the reference of a
    monitor, with ``columns`` of its channels and the ``false_alarms`` a day that are allowed."""

    to: str
    elements: tuple[str, ...] = ()
    whole: bool = False
    name: str = ""
    fmi: int = 2
    kinds: tuple[str, ...] | None = None
    platforms: tuple[str, ...] = ()
    events: bool = False
    robot: Path | None = None
    spans: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    recording: str = ""
    columns: Mapping[str, str] = field(default_factory=dict)
    false_alarms: float = 1.0


def deliver(model: Model, order: Order, output: Path) -> tuple[str, ...]:
    """Write what is ordered to ``output`` (a folder where it is several files, else a file) and say
    what it is. Nothing is written if anything goes wrong.

    Raises:
        InputError: an order that cannot be met, with the reason, or no permission to write.
    """
    if order.to not in TARGETS:
        raise InputError(Problem(f"'{order.to}' cannot be written; known: {', '.join(TARGETS)}"))
    if order.events and order.to != "fmu":
        text = f"only an FMU tells of events, not '{order.to}'; use --to fmu, or leave out --events"
        raise InputError(Problem(text))
    if (order.to in ROBOTS) != (order.robot is not None):
        text = (
            "--to urdf and --to mjcf go with --robot FILE, the robot's own file; no other form does"
        )
        raise InputError(Problem(text))
    if order.to == "curve" and order.whole:
        raise InputError(Problem("a table holds laws, not a whole model; leave out --whole"))
    if order.spans and order.to != "curve":
        text = f"--stretch and --rate are ranges of tables (--to curve), not of '{order.to}'"
        raise InputError(Problem(text))
    _require_monitor(order)
    kinds = kinds_of(order.events, order.kinds)
    require_folder(output if order.to in FOLDERS else output.absolute().parent)
    if order.to not in FOLDERS and output.is_dir():
        raise InputError(Problem("is a folder; name a file in it", file=str(output)))
    if order.to == "latex":
        from symhyb.export.latex import latex  # it imports SymPy, which takes a third of a second

        write_file(output, latex(model))
        return (f"{output}: the equations of the whole model",)
    if order.to == "curve":
        tables = curve_tables(model, order.elements, order.spans)
        _write_all(output, {one.file: one.text() for one in tables})
        return (f"{output}:", *(f"  {one.said()}" for one in tables))
    if order.robot is not None:
        return _robot(model, order.robot, order.to, output)
    name = order.name or _identifier(order, output)
    if order.to == "monitor":
        return _monitor(model, order, name, output)
    spec = spec_of(model, name, order.elements, order.whole, order.events)
    match order.to:
        case "fmu":
            packed = fmu(spec, order.fmi, kinds, order.platforms)
            write_file(output, packed)
            said = f"{output}: FMI {order.fmi}.0, {' and '.join(kinds)}, {len(packed)} bytes"
        case "c":
            _write_all(output, c_files(spec))
            said = f"{output}: {', '.join(c_files(spec))}"
        case "adams":
            _write_all(output, adams_files(spec))
            said = f"{output}: experimental, never run in Adams by us; the FMU is the surer way"
        case "simulink":
            _write_all(output, simulink_files(spec))
            said = (
                f"{output}: {name}_sfun.c says how to build it; experimental, never run in "
                "Simulink by us; the FMU is the surer way"
            )
        case _:
            write_file(output, serialised(spec.exported))
            said = (
                f"{output}: (t, x, u, p) -> (x', y) in CasADi's own form; such a file can make the "
                "program that loads it run other code, so load only those you wrote yourself"
            )
    return (said, *_interface(spec))


def _require_monitor(order: Order) -> None:
    """Refuse options of a monitor with other forms, and of other forms with a monitor."""
    problems = []
    if (order.to == "monitor") != bool(order.recording):
        text = (
            "--to monitor goes with --recording FILE, a recording of the machine as it is; no "
            "other form does"
        )
        problems.append(Problem(text))
    if order.to == "monitor" and (order.elements or order.whole):
        text = "a monitor is of the whole model always; leave out --element and --whole"
        problems.append(Problem(text))
    if problems:
        raise InputError(problems)


def _monitor(model: Model, order: Order, name: str, output: Path) -> tuple[str, ...]:
    """Write a monitor in C that begins with a recording of the machine as it is."""
    from symhyb.data.recording import read_recording
    from symhyb.export.monitor.files import monitor_files  # it imports all of a diagnosis
    from symhyb.export.monitor.held import require_monitored
    from symhyb.monitoring.begun import begun

    require_c_names(model, name)
    require_monitored(model)
    recording = read_recording(order.recording, model, order.columns)
    found = begun(model, recording, order.false_alarms, recording.name)
    files = monitor_files(found, name, recording.name, order.false_alarms)
    _write_all(output, files)
    blocks = f"{found.rows} samples a block, {found.reference.count} of them in the reference"
    return (
        f"{output}: {', '.join(files)}",
        f"  {blocks}; {len(found.gauge.hypotheses)} causes",
        "  inputs and sensors in SI, in the order that the header states",
    )


def _robot(model: Model, source: Path, form: str, output: Path) -> tuple[str, ...]:
    """Write the robot's own file with what the model says of its joints and links."""
    from symhyb.export.robot.robot_file import rewritten  # an extra, imported where it is used

    if output.exists() and source.exists() and output.samefile(source):
        raise InputError(Problem("is the robot that is read; name another file", file=str(output)))
    done = rewritten(model, source, form)
    write_file(output, done.text)
    return (
        f"{output}: {source.name} with the losses and masses of the model",
        *(f"  {x}" for x in done.notes),
    )


def _write_all(folder: Path, files: Mapping[str, str]) -> None:
    with staged(folder) as part:
        for name, text in files.items():
            (part / name).write_text(text, encoding="utf-8", newline="")


def _interface(spec: Spec) -> tuple[str, ...]:
    """What goes in and what comes out, in SI."""
    lines = []
    roles: tuple[Role, ...] = ("input", "output")
    for role in roles:
        listed = [f"{v.name} [{v.unit.text}]" for v in spec.of_role(role)]
        lines.append(f"  {role}s: {', '.join(listed) or 'none'}")
    if spec.events:
        names = ", ".join(v.name.removeprefix("mode.") for v in spec.of_role("mode"))
        lines.append(f"  event indicators: {spec.exported.indicators}, of {names}")
    if not spec.whole:
        lines.append("  the host adds +dF to its applied forces")
    return tuple(lines)


def _identifier(order: Order, output: Path) -> str:
    """The name of the C code: that of the file or folder, if it will do."""
    name = output.name.removesuffix(".fmu").removesuffix(".casadi")
    if re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,63}", name) and name not in C_WORDS:
        return name
    better = re.sub(r"\W|^(?=[^A-Za-z])", "_", name, flags=re.ASCII).strip("_") or "model_1"
    text = (
        f"'{name}' would name files and functions in C and is no name there; choose another with "
        f"--name, such as --name {better}"
    )
    raise InputError(Problem(text, file=str(output)))
