"""The equations of a model as LaTeX."""

from symhyb.mechanics.show import show_equations
from symhyb.model.types import Model


def latex(model: Model) -> str:
    """M q'' + k_c = k_e, inner states and parameters of the whole model; found elements are rows
    like all others."""
    return show_equations(model, latex=True)
