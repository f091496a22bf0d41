"""A model file as a picture of its machine."""

from collections.abc import Sequence
from pathlib import Path

from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.read import read_model
from symhyb.report.machine_figure import machine_figure
from symhyb.report.sketch import roles, sketch_of
from symhyb.writing import write_file


def draw_model(path: Path, target: Path, shown: Sequence[str] = ()) -> tuple[str, ...]:
    """Draw the machine of a model file, with the names in ``shown`` emphasised; return sentences on
    what is not drawn.

    Raises:
        InputError: the model is wrong, a name is not drawn, or the file cannot be written.
    """
    model = read_model(path)
    if model.constraints:  # where it closes
        from symhyb.numeric.lowered.machine import build

        model = build(model).model
    sketch = sketch_of(model, shown=shown)
    known = list(dict.fromkeys(name for names in roles(sketch).values() for name in names))
    problems = [
        Problem(f"nothing called '{name}' is drawn{did_you_mean(name, known)}", "--show", str(path))
        for name in shown
        if name not in known
    ]
    if problems:
        raise InputError(problems)
    write_file(target, machine_figure(sketch, model.title, target.suffix))
    return sketch.left_out
