"""Write model files: a correction is text appended at the end, a re-estimate a number in place.

Every other byte of what a person wrote stays as it was, so a diff shows only the correction.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path as FilePath

from symhyb.asked import asked
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.limits import FMU_BYTES, content_of
from symhyb.model.actuators import ACTUATOR_KEYS, FAULT_KEYS
from symhyb.model.read import parse_model
from symhyb.model.render import element_lines, newline_of, render, rounded
from symhyb.model.source import Entry, Path, Source, scan
from symhyb.model.types import Element, Model
from symhyb.model.weights import write_weights
from symhyb.writing import write_file

Edit = tuple[int, int, str]
"""Replace the characters from one offset to another by a text."""


def append_elements(model: Model, elements: Iterable[Element]) -> Model:
    """Return the model with more elements; its text begins with every byte of the old one.

    Raises:
        InputError: the result would not be a valid model (a name that is taken, a wrong unit).
    """
    text = text_of(model)
    newline = newline_of(text)
    taken = {element.name for element in model.elements}
    for element in elements:
        if element.name in taken:
            sentence = f"there is already an element '{element.name}'"
            raise InputError(Problem(sentence, "elements", model.file))
        taken.add(element.name)
        text += newline if text.endswith("\n") else newline * 2
        text += newline.join((*element_lines(element), ""))
    return parse_model(text, model.file)


def replace_parameters(model: Model, values: Mapping[str, tuple[float, float | None]]) -> Model:
    """Return the model with re-estimated parameters, changed in place; ``was`` keeps the old value.

    ``values`` maps ``Parameter.path`` to (value, sd) in the unit that the file states there; an sd
    of None leaves the file's. ``laser.gain`` is added to its channel where the file has none.

    Raises:
        InputError: a path that the model does not have.
    """
    text = text_of(model)
    source = scan(text)
    edits: list[Edit] = []
    for path, (value, sd) in values.items():
        edits += _edits(source, _path_of(model, path), value, sd)
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    return parse_model(text, model.file)


def set_parameters(model: Model, values: Mapping[str, float]) -> Model:
    """Return the model with other values of parameters, stated in place as if the file had been
    written with them: ``sd`` stays, and no past value is noted.

    ``values`` maps ``Parameter.path`` to a value in the unit that the file states there.

    Raises:
        InputError: paths that the model does not have, or whose value its file does not state.
    """
    if not values:
        return model
    text = text_of(model)
    source = scan(text)
    edits: list[Edit] = []
    problems: list[Problem] = []
    for path, value in values.items():
        try:
            place = _path_of(model, path)
        except InputError as error:
            problems.extend(error.problems)
            continue
        entry = source.entries.get((*place, "value")) or source.entries.get(place)
        if entry is None:
            said = f"'{path}' has no value in the file that another could replace; state one"
            problems.append(Problem(said, file=model.file))
        else:
            edits.append((entry.start, entry.end, repr(float(value))))
    if problems:
        raise InputError(problems)
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    return parse_model(text, model.file)


def hold_inputs(model: Model, names: Sequence[str]) -> Model:
    """Return the model with these inputs held from each sample to the next, stated in place.

    Raises:
        InputError: a name that is no input of the model.
    """
    if not names:
        return model
    text = text_of(model)
    source = scan(text)
    edits: list[Edit] = []
    for name in names:
        if name not in model.inputs.names():
            said = f"there is no input '{name}'{did_you_mean(name, model.inputs.names())}"
            raise InputError(Problem(said, file=model.file))
        stated = source.entries.get(("inputs", name, "between"))
        if stated is None:
            unit = source.entries[("inputs", name, "unit")]
            edits.append(_insertion(source, unit, {"between": '"held"'}))
        else:
            edits.append((stated.start, stated.end, '"held"'))
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    return parse_model(text, model.file)


@asked
def write_model(model: Model, path: str | FilePath) -> None:
    """Write a model file whole or not at all. The weights of its networks, the points of its
    curves, the grids of its maps and its FMU or file of MuJoCo go where the file says that they
    are.

    Raises:
        InputError: a file cannot be written, or other weights or points, another FMU or another
            file of MuJoCo have the name of these.
    """
    write_weights(model, FilePath(path))
    _write_points(model, FilePath(path).parent)
    _copy_engine(model, FilePath(path))
    write_file(path, text_of(model))


def _write_points(model: Model, folder: FilePath) -> None:
    """Put the files of curves and maps beside a model file; one that is there already stays as it
    is."""
    for word, item in ((word, one) for word, files in model.table_files().items() for one in files):
        place, data = folder / item.file, item.content.encode()
        try:
            there = place.read_bytes()
        except OSError:
            write_file(place, data)
            continue
        if there != data:
            said = f"holds other points than the {word[:-1]}; write the model into another folder"
            raise InputError(Problem(said, file=str(place)))


def _copy_engine(model: Model, target: FilePath) -> None:
    """Put the FMU or the file of MuJoCo of a model beside a model file; one that is there already
    stays as it is."""
    if model.engine is None:
        return
    place, source = model.engine.path(str(target)), model.engine.path(model.file)
    if place.resolve() == source.resolve():
        return
    data = content_of(source, FMU_BYTES)
    if not place.exists():
        write_file(place, data)
    elif content_of(place, FMU_BYTES) != data:
        what = "FMU" if model.fmu else "file of MuJoCo"
        said = f"is another {what}; write the model into another folder"
        raise InputError(Problem(said, file=str(place)))


def text_of(model: Model) -> str:
    """Return the text of a model: as it was written if it still says the same, else rendered."""
    if model.text and parse_model(model.text, model.file) == model:
        return model.text
    return render(model)


def _path_of(model: Model, path: str) -> Path:
    """Say where in the file a parameter stands, from its unique path."""
    owner, _, name = path.rpartition(".")
    if not owner and any(parameter.name == name for parameter in model.parameters):
        return ("parameters", name)
    for element in model.elements:
        if element.name == owner and any(own.name == name for own in element.parameters):
            return ("elements", owner, "parameters", name)
    if name in (*FAULT_KEYS, *ACTUATOR_KEYS) and owner in model.inputs.names():
        return ("inputs", owner, name)
    if name in FAULT_KEYS and owner in model.sensors.names():
        return ("sensors", owner, name)
    known = [parameter.path for parameter in model.all_parameters()]
    raise InputError(
        Problem(f"there is no parameter '{path}'{did_you_mean(path, known)}", file=model.file)
    )


def _edits(source: Source, path: Path, value: float, sd: float | None) -> list[Edit]:
    """Return the edits that change one parameter and keep its past."""
    deviation = "" if sd is None else f", sd = {rounded(sd, 6)}"
    stated = source.entries.get(path)
    entry = source.entries.get((*path, "value"))
    if stated is None:  # a channel without this key acts as if it stated the neutral value
        was = {"gain": ", was = 1.0", "limit": "", "rate_limit": ""}.get(path[-1], ", was = 0.0")
        table = f"{{ value = {rounded(value)}{was}{deviation} }}"
        return [_insertion(source, source.entries[(*path[:-1], "unit")], {path[-1]: table})]
    if entry is None:  # a plain number, as in: gain = 1.0
        was = source.text[stated.start : stated.end]
        table = f"{{ value = {rounded(value)}, was = {was}{deviation} }}"
        return [(stated.start, stated.end, table)]
    news = {"was": source.text[entry.start : entry.end]}
    if sd is not None:
        news["sd"] = rounded(sd, 6)
    edits = [(entry.start, entry.end, rounded(value))]
    missing = {}
    for key, new in news.items():
        old = source.entries.get((*path, key))
        if old is None:
            missing[key] = new
        else:
            edits.append((old.start, old.end, new))
    return [*edits, _insertion(source, entry, missing)] if missing else edits


def _insertion(source: Source, after: Entry, values: Mapping[str, str]) -> Edit:
    """Add keys beside an entry: behind it inside braces, else on lines of their own."""
    if after.inline:
        return (after.end, after.end, "".join(f", {key} = {new}" for key, new in values.items()))
    newline = newline_of(source.text)
    prefix = source.text[after.key : after.last]
    lines = "".join(f"{prefix}{key} = {new}{newline}" for key, new in values.items())
    end = source.text.find("\n", after.end) + 1
    return (end, end, lines) if end else (len(source.text), len(source.text), newline + lines)
