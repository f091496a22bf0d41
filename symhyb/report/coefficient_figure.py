"""The picture of a coefficient that a curve gives: damping over a stretch."""

import numpy as np

from symhyb.discrepancy.results import Found
from symhyb.laws.curve import NOUNS
from symhyb.report.canvas import BAND, LAW, QUIET, bracketed, drawing, legend, svg

FINE = 400  # points of the drawn line


def coefficient_figure(effect: Found) -> bytes:
    """Draw the curve of a found element over what it is a function of, through its points, with a
    band of two of their deviations, all in the units of the model file. The bytes are an SVG."""
    element = effect.element
    assert element.curve is not None
    along, up = element.curve.units
    x, y = np.array(element.curve.points).T
    sd = np.array([one.sd for one in effect.estimates])
    fine = np.linspace(x[0], x[-1], FINE)
    line = element.curve.characteristic(along.factor * fine) / up.factor
    wide = 2 * np.interp(fine, x, sd)
    with drawing(2.6) as figure:
        panel = figure.subplots()
        panel.fill_between(fine, line - wide, line + wide, color=BAND, lw=0)
        panel.axhline(0.0, color=QUIET, lw=0.8)
        panel.plot(fine, line, color=LAW, label="found curve, ± two sd")
        panel.errorbar(x, y, sd, fmt="s", color=LAW, ms=4, label="points, ± one sd")
        panel.set_xlabel(f"stretch{bracketed(along.text)}")
        panel.set_title(f"{coefficient_of(effect)}{bracketed(up.text)}")
        legend(panel)
        return svg(figure)


def coefficient_of(effect: Found) -> str:
    """What the curve of a found element is, in a word; empty of a force."""
    return NOUNS.get(effect.element.option("times", ""), "")
