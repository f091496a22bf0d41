"""A model as CasADi functions: the seam from SymPy, the machine, its constraints and states."""
