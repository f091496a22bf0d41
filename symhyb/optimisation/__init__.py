"""For scripts that optimise: runs with their slopes, objectives for solvers, many parameter sets.

No diagnosis needs this room, and nothing in symhyb imports it (docs/optimisation.md).
"""
