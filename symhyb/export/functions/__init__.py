"""A machine, or some of its elements, as one CasADi function that C code can be made of."""
