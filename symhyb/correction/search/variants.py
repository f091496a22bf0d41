"""Variants of a law that was found, tried where something is left: its file states them."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from symhyb.correction.search.setting import Setting
from symhyb.discrepancy.places.candidates import hypothesis_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.judgement import NEGLIGIBLE
from symhyb.laws.variants import Load, Pace, Row, Variant
from symhyb.model.expression import evaluate, parse_expression
from symhyb.model.types import On, Place
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array


def variants_of(
    setting: Setting, cause: Hypothesis, row: Row, product: Hypothesis | None = None
) -> Iterator[tuple[Hypothesis, dict[str, float]]]:
    """Each variant of a fitted cause with the first guess of its keys, SI; ``row`` holds the values
    of the plain law. With a ``product`` that is predicted to explain more, those that say it by
    name, and else none of these."""
    if cause.place not in setting.library.places:
        return
    if product is not None and product.place != cause.place:
        return
    pace = pace_of(setting, cause.place)
    for variant in KINDS[cause.kind].variants(row, pace, cause.added):
        if not _says(variant, product):
            continue
        tried = _varied(_plain(cause, variant), variant)
        yield tried, {key: variant.first[key] for key in tried.keys}


def _says(variant: Variant, product: Hypothesis | None) -> bool:
    """Whether a variant says a product by name; without one, whether it says none."""
    if product is None:
        return not variant.product
    place = product.place
    return isinstance(place, On) and variant.product.format(s=place.coordinate) == product.path


def _plain(cause: Hypothesis, variant: Variant) -> Hypothesis:
    """The plain law that is varied: the cause itself, or another that it imitates."""
    if variant.candidate is None or cause.place is None:
        return cause
    return hypothesis_of(variant.law, cause.place, variant.candidate)


def _varied(plain: Hypothesis, variant: Variant) -> Hypothesis:
    """A law with more keys; the refined keys are tried at where they begin."""
    if not variant.added:
        return plain
    shape = dict(plain.shape)
    if variant.tried:
        shape |= variant.tried
        return replace(plain, shape=tuple(shape.items()), added=(*plain.added, *variant.added))
    shape |= {key: variant.first[key] for key in variant.added} | dict(variant.shape)
    shape |= {key: variant.first[key] for key in plain.refined if key not in plain.tied}
    return replace(
        plain,
        shape=tuple(shape.items()),
        refined=(*plain.refined, *variant.added),
        tied=(*plain.tied, *variant.tied),
        options=(*plain.options, *variant.options),
        added=(*plain.added, *variant.added),
        bounds=(*plain.bounds, *variant.bounds),
    )


def pace_of(setting: Setting, place: Place) -> Pace:
    """How a place of the library moves along all recordings."""
    index = setting.library.places.index(place)
    parts = [
        setting.library.motion(item.course(setting.library.machine))
        for item in setting.stages[0].cuts
    ]
    stretch = np.concatenate([s[:, index] - s[:, index].mean() for s, _ in parts])
    middle = float(np.mean([s[:, index].mean() for s, _ in parts]))
    rate = np.concatenate([r[:, index] for _, r in parts])
    typical = float(np.sqrt(np.mean(rate**2)))
    return Pace(
        typical,
        float(np.quantile(np.abs(rate), 0.99)),
        float(np.std(stretch)) / typical if typical > 0 else 0.0,
        _loads(setting, place),
        _turning(setting, place),
        middle,
    )


def _turning(setting: Setting, place: Place) -> float:
    """The speed within which the dry friction turns over that is tried at a place, SI; 0 if none
    is."""
    for cause in setting.library.hypotheses:
        name = KINDS[cause.kind].smoothed_over if cause.kind in KINDS else None
        if cause.place == place and name:
            return dict(cause.shape)[name]
    return 0.0


def _loads(setting: Setting, place: Place) -> tuple[Load, ...]:
    """What presses at a coordinate, those forces whose size changes along the recordings."""
    model = setting.windows.machine.model
    if not isinstance(place, On) or not place.plain:
        return ()
    from symhyb.mechanics.loads import loads_on  # SymPy takes half a second to import

    found = []
    for text in loads_on(model, place.coordinate):
        size = np.concatenate([_along(setting, item, text) for item in setting.stages[0].cuts])
        typical = float(np.sqrt(np.mean(size**2)))
        if np.isfinite(typical) and np.std(size) > NEGLIGIBLE * typical:
            found.append(Load(text, typical))
    return tuple(found)


def _along(setting: Setting, item: Cut, text: str) -> Array:
    """The size (N,) of a force, an expression of the model file, along a recording, N."""
    machine = setting.library.machine
    model, course = setting.windows.machine.model, item.course(machine)
    values: dict[tuple[str, int] | str, Array | float] = {"t": course.t}
    values |= {one.name: course.known.get(one.path, one.si) for one in model.parameters}
    for i, one in enumerate(machine.model.coordinates):
        values |= {one.name: course.q[:, i], (one.name, 1): course.v[:, i]}
    values |= {one.name: course.z[:, i] for i, one in enumerate(machine.model.states)}
    values |= {one.name: course.u[:, i] for i, one in enumerate(machine.model.recorded_inputs)}
    return np.abs(evaluate(parse_expression(text), values)) * np.ones(course.t.size)
