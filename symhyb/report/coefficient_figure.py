"""The picture of a coefficient that a curve gives, damping over a stretch, and of a force over the
rate with what it is multiplied by over the stretch."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from symhyb.discrepancy.results import Found
from symhyb.laws.curve import NOUNS
from symhyb.model.curves import Curve
from symhyb.report.canvas import BAND, LAW, QUIET, bracketed, drawing, legend, svg

FINE = 400  # points of the drawn line
PRODUCT = "loss"


class _Panel(NamedTuple):
    """A curve with the standard deviations of its points, and what its axes are."""

    curve: Curve
    sd: tuple[float, ...]
    over: str
    title: str


def coefficient_figure(effect: Found) -> bytes:
    """Draw the curve of a found element over what it is a function of, and what it is multiplied
    by, through their points, with a band of two of their deviations, all in the units of the model
    file. The bytes are an SVG."""
    panels = _panels(effect)
    with drawing(2.6 * len(panels)) as figure:
        axes = np.atleast_1d(figure.subplots(len(panels), 1))
        for panel, one in zip(axes, panels, strict=True):
            _draw(panel, one)
        legend(axes[-1])
        return svg(figure)


def _panels(effect: Found) -> list[_Panel]:
    element, found = effect.element, dict(effect.element.found)
    assert element.curve is not None
    own = _deviations(found, "sd")
    if element.by_stretch is None:
        return [_Panel(element.curve, own, "stretch", coefficient_of(effect))]
    more = _deviations(found, "sd_by_stretch")
    return [
        _Panel(element.curve, own, "rate", "force where the factor is 1"),
        _Panel(element.by_stretch, more, "stretch", "factor"),
    ]


def _deviations(found: Mapping[str, object], key: str) -> tuple[float, ...]:
    """The deviations of the values of a curve, as its provenance states them."""
    stated = found[key]
    assert isinstance(stated, tuple)
    return stated


def _draw(panel: Any, one: _Panel) -> None:
    along, up = one.curve.units
    x, y = np.array(one.curve.points).T
    sd = np.array(one.sd)
    fine = np.linspace(x[0], x[-1], FINE)
    line = one.curve.characteristic(along.factor * fine) / up.factor
    wide = 2 * np.interp(fine, x, sd)
    panel.fill_between(fine, line - wide, line + wide, color=BAND, lw=0)
    panel.axhline(0.0, color=QUIET, lw=0.8)
    panel.plot(fine, line, color=LAW, label="found curve, ± two sd")
    panel.errorbar(x, y, sd, fmt="s", color=LAW, ms=4, label="points, ± one sd")
    panel.set_xlabel(f"{one.over}{bracketed(along.text)}")
    panel.set_title(f"{one.title}{bracketed(up.text)}")


def coefficient_of(effect: Found) -> str:
    """What the curve of a found element is, in a word; empty of a force."""
    if effect.element.by_stretch is not None:
        return PRODUCT
    return NOUNS.get(effect.element.option("times", ""), "")
