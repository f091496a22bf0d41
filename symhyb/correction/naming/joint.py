"""How the errors of all claimed numbers go together: the correlations of the last fit."""

from collections.abc import Iterator, Sequence

import numpy as np

from symhyb.correction.naming.delays import shared_path
from symhyb.correction.naming.findings import Named, element_names
from symhyb.correction.search.trajectory import Refined, late_sensors
from symhyb.discrepancy.posterior import Posterior
from symhyb.discrepancy.results import Diagnosis
from symhyb.model.actuators import SENSOR_LAG
from symhyb.model.types import Model

Row = tuple[str, str, float, float, str, str]
"""Name, path in the fit, value, sd, unit, and name in the corrected model file."""


def posterior_of(
    model: Model, final: Refined, items: Sequence[Named], answer: Diagnosis
) -> Posterior | None:
    """The numbers that ``answer`` claims, as a joint Gaussian in the units of the model file: each
    with its stated deviation, their correlations those of the fit. Of numbers that each recording
    has its own value of, those of the first. None where nothing is claimed, or a number has no
    deviation.
    """
    rows = list(_claimed(model, final, items, answer))
    paths = [row[1] for row in rows]
    if not rows or any(path not in final.paths for path in paths):
        return None
    columns = [final.paths.index(path) for path in paths]
    if final.owned:
        columns = [final.owned[0][column] for column in columns]
    covariance = final.fit.covariance[np.ix_(columns, columns)]
    fitted, stated = np.sqrt(np.diag(covariance)), np.array([row[3] for row in rows])
    if not (np.isfinite(covariance).all() and (fitted > 0).all() and np.isfinite(stated).all()):
        return None
    wider = stated / fitted
    return Posterior(
        tuple(row[0] for row in rows),
        np.array([row[2] for row in rows]),
        covariance * np.outer(wider, wider),
        tuple(row[4] for row in rows),
        tuple(row[5] for row in rows),
    )


def _claimed(
    model: Model, final: Refined, items: Sequence[Named], answer: Diagnosis
) -> Iterator[Row]:
    """Every claimed number with the path under which it was fitted."""
    known = dict(zip(element_names(model, items), items, strict=True))
    for found in answer.found:
        item = known.get(found.element.name)
        for one in found.estimates:
            path = "" if item is None else _path(final, item, one.term)
            own = found.element.name
            yield f"{own}.{one.term}", path, one.value, one.sd, one.unit, f"{own}.{one.name}"
    for p in answer.parameters:
        yield p.name, p.name, p.value, p.sd, p.unit, p.name
    for m in answer.measurement:
        name = f"{m.channel}.{m.kind}"
        late = (cause.path for cause in final.causes if m.channel in late_sensors(cause))
        path = next(late, "") if m.kind == SENSOR_LAG else name
        path = shared_path(final.machine.model, m.channel) if m.together else path
        yield name, path, m.value, m.sd, m.unit, name


def _path(final: Refined, item: Named, term: str) -> str:
    """Where the fit has the number of a key; empty if it was not fitted."""
    for i in item.causes:
        if term in final.causes[i].keys:
            return f"cause{i}.{term}"
    return ""
