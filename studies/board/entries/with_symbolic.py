"""Symbolic regression of the mismatch in force, by PySR or gplearn, whichever is installed.

with_symbolic.py CASE ANSWER pysr|gplearn

On each coordinate ΔF is regressed on positions, speeds and inputs, all over their RMS, along the
first two thirds of the recording. A formula is kept if on the last third, in twenty blocks, it
leaves less of the squared mismatch than nothing does, by three standard errors of the blocks' mean.
"""

import importlib.util
import re
import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from common import element, folders, write

BLOCKS, ERRORS = 20, 3.0
ROWS = 800  # samples that a search sees, evenly spread
Found = tuple[str, Callable[[Any], Any]]  # a formula of x0, x1, …, and its values


def pysr(x: Any, y: Any) -> Found:
    """The formula that PySR selects."""
    from pysr import PySRRegressor

    search = PySRRegressor(
        binary_operators=["+", "-", "*"],
        unary_operators=["abs", "sin", "tanh"],
        niterations=40,
        maxsize=20,
        deterministic=True,
        parallelism="serial",
        random_state=0,
        progress=False,
        verbosity=0,
        temp_equation_file=True,
    ).fit(x, y)
    return str(search.get_best()["equation"]), search.predict


def gplearn(x: Any, y: Any) -> Found:
    """The formula that gplearn selects."""
    from gplearn.genetic import SymbolicRegressor

    search = SymbolicRegressor(
        population_size=1000,
        generations=15,
        function_set=("add", "sub", "mul", "abs", "sin"),
        metric="mse",
        parsimony_coefficient="auto",
        random_state=0,
    ).fit(x, y)
    return written(list(search._program.program)), search.predict


def written(program: list[Any]) -> str:
    """A program of gplearn, in prefix order, as a formula."""
    infix = {"add": "+", "sub": "-", "mul": "*"}

    def term() -> str:
        node = program.pop(0)
        if isinstance(node, int):
            return f"x{node}"
        if isinstance(node, float):
            return f"({node!r})"
        parts = [term() for _ in range(node.arity)]
        if node.name in infix:
            return f"({f' {infix[node.name]} '.join(parts)})"
        return f"{node.name}({parts[0]})"

    return term()


def law(name: str, unit: str, formula: str, scale: float, columns: Mapping[str, Any]) -> str:
    """The element of a formula of x0, x1, … on a coordinate; ``columns`` give the size and the unit
    of what each of them is, by name, which may be x1."""
    names = list(columns)
    angle = unit == "rad"
    key, force = ("torque", "N*m") if angle else ("force", "N")

    def column(match: re.Match[str]) -> str:
        return f"({names[int(match[1])]}/size{match[1]}_)"

    named = re.sub(r"\bx(\d+)\b", column, formula)
    lines = ["", f"[elements.formula_{name}]", 'kind = "law"', f'on = "{name}"']
    lines += [f'{key} = "scale_*({named})"', f"[elements.formula_{name}.parameters]"]
    lines += [f'scale_ = {{ value = {scale!r}, unit = "{force}" }}']
    lines += [
        f'size{i}_ = {{ value = {size!r}, unit = "{of}" }}'
        for i, (size, of) in enumerate(columns.values())
        if f"size{i}_" in named
    ]
    return "\n".join([*lines, ""])


def better(before: Any, after: Any) -> bool:
    """Whether blocks of squared errors are smaller after, by three standard errors of the mean."""
    gain = np.array([np.mean(b - a) for b, a in zip(*_blocks(before, after), strict=True)])
    return bool(gain.mean() > ERRORS * gain.std(ddof=1) / np.sqrt(BLOCKS))


def _blocks(*errors: Any) -> list[list[Any]]:
    return [np.array_split(one**2, BLOCKS) for one in errors]


def main() -> None:
    """Search on every coordinate."""
    tool = sys.argv.pop()
    if importlib.util.find_spec(tool) is None:
        raise SystemExit(f"{tool} is not installed")
    case, answer = folders()
    import symhyb as sh

    model = sh.read_model(case / "model.toml")
    train = sh.read_recording(case / "train.csv", model)
    lacking = sh.compare(model, train)
    motion, names = lacking.motion, [one.name for one in model.coordinates]
    columns = dict(zip(names, motion.q.T, strict=True))
    columns |= {f"{name}'": v for name, v in zip(names, motion.v.T, strict=True)}
    columns |= {one.name: np.asarray(train.inputs[one.name]) for one in model.recorded_inputs}
    columns = {k: x for k, x in columns.items() if x.size == motion.t.size and x.std() > 0}
    units = {one.name: one.unit.text for one in (*model.coordinates, *model.recorded_inputs)}
    units |= {f"{name}'": f"{units[name]}/s" for name in names}
    size = {name: float(np.sqrt(np.mean(x**2))) for name, x in columns.items()}
    x = np.column_stack([x / size[name] for name, x in columns.items()])
    seen = 2 * len(x) // 3
    rows = np.linspace(0, seen - 1, min(seen, ROWS)).astype(int)
    text, found = (case / "model.toml").read_text(encoding="utf-8"), []
    for i, name in enumerate(names):
        force = lacking.force[:, i]
        scale = float(np.sqrt(np.mean(force[:seen] ** 2)))
        if not scale > 0:
            continue
        formula, values = {"pysr": pysr, "gplearn": gplearn}[tool](x[rows], force[rows] / scale)
        if not better(force[seen:] / scale, force[seen:] / scale - values(x[seen:])):
            continue
        sized = {column: (size[column], units[column]) for column in columns}
        text += law(name, units[name], formula, scale, sized)
        found.append(element("law", {"on": name}, {}))
    verdict = "missing physics" if found else "nothing missing"
    write(answer, verdict=verdict, found=found)
    (answer / "corrected.toml").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
