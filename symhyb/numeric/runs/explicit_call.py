"""How the integrator in machine code is called: the structures that it is given."""

import ctypes

POINTER = ctypes.c_void_p


class List(ctypes.Structure):
    """The instruction list of a machine, field by field as the C text declares ``struct list``."""

    _fields_ = (
        *((name, POINTER) for name in ("slots", "steps", "loads", "stores")),
        *((name, ctypes.c_longlong) for name in ("n_steps", "n_loads", "n_stores", "n_slopes")),
    )


class Task(ctypes.Structure):
    """What the integrator in machine code is given; see :mod:`.explicit_source`."""

    _fields_ = (
        *((n, ctypes.c_longlong) for n in ("states", "drives", "nodes", "outputs", "steps_most")),
        *((name, ctypes.c_double) for name in ("relative", "longest")),
        *(
            (name, POINTER)
            for name in (
                "node_t",
                "node_d",
                "t",
                "absolute",
                "bound",
                "start",
                "x",
                "work",
                "drive",
                "reach",
                "count",
                "place",
                "tape_x",
                "tape_t",
                "tape_i",
            )
        ),
        ("tape_most", ctypes.c_longlong),
        *((name, ctypes.c_double) for name in ("begin", "end", "first")),
        *((name, ctypes.c_longlong) for name in ("row", "watches")),
        *((name, POINTER) for name in ("watch", "watch_memory", "seen")),
        ("suspect", ctypes.c_double),
        *((name, ctypes.c_longlong) for name in ("pause", "resumed")),
    )
