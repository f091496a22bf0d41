"""How the integrator in machine code is called: the structures that it is given, declared once for
C and for Python."""

import ctypes
import re
from typing import Any

POINTER = ctypes.c_void_p
LIST = """
  double *slots; const int *steps, *loads, *stores; long long n_steps, n_loads, n_stores, n_slopes;
"""
TASK = """
  long long states, drives, nodes, outputs, steps_most; double relative, longest;
  const double *node_t, *node_d, *t, *absolute, *bound, *start; double *x, *work, *drive, *reach;
  long long *count; double *place, *tape_x, *tape_t; long long *tape_i, tape_most;
  double begin, end, first; long long row, watches; watch_type *watch; void *watch_memory;
  double *seen, suspect; long long pause, resumed;
"""


def _fields(text: str) -> list[tuple[str, Any]]:
    """The names that C declares, in their order, with their types."""
    found: list[tuple[str, Any]] = []
    for declared in text.split(";")[:-1]:
        number = ctypes.c_double if "double" in declared else ctypes.c_longlong
        for star, name in re.findall(r"(\*?)(\w+)\s*(?:,|$)", declared):
            found.append((name, POINTER if star else number))
    return found


class List(ctypes.Structure):
    """The instruction list of a machine."""

    _fields_ = _fields(LIST)


class Task(ctypes.Structure):
    """What the integrator is given; see :mod:`.explicit_source`."""

    _fields_ = _fields(TASK)
