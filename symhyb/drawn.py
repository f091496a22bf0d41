"""Where values are drawn: the one import that goes upwards through the layers.

``recording.plot()`` and its like belong to the values that are drawn, far below the one room in
which matplotlib is used. This function is all that joins the two, when a picture is asked for.
"""

from typing import Any


def drawn(what: str, value: object, ax: Any, **options: Any) -> Any:
    """Draw a value on axes of matplotlib, by the function of :mod:`symhyb.report.axes` that is
    called ``what``; returns the axes."""
    from symhyb.report import axes

    return getattr(axes, f"draw_{what}")(value, ax, **options)
