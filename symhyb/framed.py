"""Values as frames of pandas and datasets of xarray: like files, in the units of the model file.

``attrs["units"]`` says which they are; :data:`SI` stands for the coherent unit of whatever it is.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from symhyb.errors import InputError, Problem

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

UNITS, SI = "units", "SI"  # the key of ``attrs``; where no unit of a model file is known
Signal = tuple[str, NDArray[np.float64], str]
"""A name, values (N,) and the unit that they are in."""


def frame_of(t: NDArray[np.float64], signals: Iterable[Signal], **about: object) -> "pd.DataFrame":
    """A frame with the index ``t`` (N,) in s and a column for each of ``signals``: its name, values
    (N,) and the unit they are in, which ``attrs["units"]`` holds; ``about`` are further attrs."""
    import pandas as pd

    columns = list(signals)
    frame = pd.DataFrame(
        {name: values for name, values, _ in columns}, index=pd.Index(t, name="t", dtype=float)
    )
    frame.attrs[UNITS] = {"t": "s", **{name: unit for name, _, unit in columns}}
    frame.attrs.update(about)
    return frame


def dataset_of(t: NDArray[np.float64], signals: Iterable[Signal], **about: object) -> "xr.Dataset":
    """A dataset along ``t`` (N,) in s with a variable for each of ``signals``: its name, values
    (N,) and the unit they are in, which its ``attrs["units"]`` holds; ``about`` are attrs of the
    whole.

    Raises:
        InputError: xarray is not installed.
    """
    xarray = the_xarray()
    variables = {name: ("t", values, {UNITS: unit}) for name, values, unit in signals}
    whole: xr.Dataset = xarray.Dataset(variables, {"t": ("t", t, {UNITS: "s"})}, about)
    return whole


def the_xarray() -> Any:
    """The package xarray, which an extra brings.

    Raises:
        InputError: it is not installed.
    """
    try:
        import xarray
    except ImportError as error:
        text = f'needs the package xarray ({error}); run: pip install "symhyb[xarray]"'
        raise InputError(Problem(text)) from error
    return xarray
