"""The files of a monitor in C: header, code, a program that watches standard input, and words."""

from collections.abc import Mapping, Sequence

import numpy as np

from symhyb.export.c_code import array, comment, filled, part
from symhyb.export.functions.monitored import monitored
from symhyb.export.monitor.constants import Constants, constants_of
from symhyb.export.monitor.held import require_monitored
from symhyb.monitoring.begun import Begun
from symhyb.units import Unit

PARTS = ("monitor/block.c", "monitor/windows.c", "monitor/judge.c")


def monitor_files(
    begun: Begun, identifier: str, reference: str, false_alarms: float
) -> dict[str, str]:
    """The files of a monitor that begins with a reference, by name; ``reference`` says which
    recording that was, ``false_alarms`` how many a day it was made for.

    Raises:
        InputError: a machine that has no monitor in C.
    """
    prepared = begun.gauge.prepared
    require_monitored(prepared.model, prepared.runs[0].motion.blind)
    constants = constants_of(begun)
    values = _values(begun, constants, identifier) | {
        "REFERENCE": comment(reference),
        "FALSE": f"{false_alarms:g}",
    }
    return {
        f"{identifier}.h": filled("monitor/monitor.h", values),
        f"{identifier}.c": _code(begun, constants, identifier, values),
        f"{identifier}_main.c": filled("monitor/main.c", values),
        "README.md": filled("monitor/about.md", values),
    }


def _code(begun: Begun, constants: Constants, identifier: str, values: Mapping[str, str]) -> str:
    setting = begun.gauge.setting
    made = monitored(setting.windows, setting.library, constants.motion, constants.steep)
    sizes = {**constants.sizes, **made.sizes()}
    upper = identifier.upper()
    kinds = ("NOTHING", "CHANGED", "NAMED", "UNREADABLE")
    lines = [
        f'#include "{identifier}.h"',
        "#include <math.h>",
        "#include <stdlib.h>",
        "#include <string.h>",
        f"/* {identifier}: {values['TITLE']}. Everything is in SI. */",
        "#define CASADI_SYMBOL_EXPORT static inline /* no warnings about what is not called */",
        made.source(identifier),
        *(f"#define {name} {size}" for name, size in sizes.items()),
        *(f"#define {name} {number!r}" for name, number in constants.numbers.items()),
        *(_integers(name, own) for name, own in constants.integers.items()),
        *(array(name, own) for name, own in constants.arrays.items()),
        _texts(f"{identifier}_cause", constants.causes),
        _integers(f"{identifier}_first", constants.integers["FIRST"], "const int"),
        _texts(f"{identifier}_number", [name for name, _, _ in constants.amounts]),
        _texts(f"{identifier}_unit", [unit for _, unit, _ in constants.amounts]),
        array(f"{identifier}_factor", [one for _, _, one in constants.amounts], "const double"),
        f"typedef {identifier}_monitor Monitor;",
        f"typedef {identifier}_block Block;",
        f"typedef {identifier}_event Event;",
        *(f"#define {kind} {upper}_{kind}" for kind in kinds),
        "typedef int (*Entry)(const double **, double **, casadi_int *, double *, int);",
        *(part(one).replace("NAME_", f"{identifier}_") for one in PARTS),
    ]
    return "\n".join(lines) + "\n"


def _values(begun: Begun, constants: Constants, identifier: str) -> dict[str, str]:
    """What stands in place of the @KEYS@ of the header and the rest."""
    model, s = begun.gauge.prepared.model, constants.sizes
    parts = s["STEPS"] * (s["FINE"] if s["N_SHARP"] else 1)
    width = s["N_X"] + s["N_F"] + s["N_Q"]
    more = {
        "U": max(s["N_U"], 1),
        "N_CAUSES_1": s["N_CAUSES"] + 1,
        "KNOTS": max(s["N_B"], s["N"]) + 7,
        "SIZE": s["N_B"] * s["N_Q"],
        "BAND": 6 * s["N_Q"],
        "SHARP": max(s["N_SHARP"], 1),
        "N_FINE": s["N"] if s["SMOOTH_ANY"] else 1,
        "PARTS": parts,
        "WIDTH": width,
        "RATES": s["N_X"] - s["N_Q"],
        "JOINED": width + s["N_Q"],
        "MOVED": 2 * s["N_Q"] + s["N_COLUMNS"] + 1,
    }
    listed = [
        *(_listed("u", i, one.name, one.unit) for i, one in enumerate(model.inputs)),
        *(_listed("y", i, one.name, one.unit) for i, one in enumerate(model.sensors)),
    ]
    block_s = begun.rows * float(np.median(np.diff(begun.gauge.prepared.runs[0].recording.t)))
    return {
        **{name: str(size) for name, size in {**s, **more}.items()},
        "NAME": identifier,
        "UPPER": identifier.upper(),
        "TITLE": comment(model.title or model.file),
        "BLOCK_S": f"{block_s / s['THINNING']:.3g}",
        "LISTED": "\n".join(listed),
    }


def _listed(array_name: str, i: int, name: str, unit: Unit) -> str:
    base = (
        ""
        if unit.factor == 1
        else f", of which the model file's unit {unit.text} is {unit.factor:g}"
    )
    return f"     {array_name}[{i}] {name}, in SI{base or f' ({unit.text})'}"


def _integers(name: str, values: Sequence[int], kind: str = "static const int") -> str:
    listed = [str(int(value)) for value in values] or ["0"]
    return f"{kind} {name}[{len(listed)}] = {{{', '.join(listed)}}};"


def _texts(name: str, values: Sequence[str]) -> str:
    """A C array of texts, each within its quotes whatever it holds."""
    quoted = ", ".join(f'"{comment(value).replace(chr(34), chr(39))}"' for value in values)
    return f"const char *const {name}[{len(values)}] = {{{quoted}}};"
