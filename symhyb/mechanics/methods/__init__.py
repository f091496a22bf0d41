"""Equations of motion that SymPy's mechanics derived, as a model."""
